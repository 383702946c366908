"""Motion: sampled from whatever moves objects, and written back as keyframes."""

from __future__ import annotations

from pathlib import Path

import bpy
import mathutils
import numpy as np

from tests.blender.helpers import add, box, relative_gap
from unisg_blender.blender import ReadReport, read_file, read_scene, sample_animation, save_blend, write_scene
from unisg_blender.scene import world_matrices

FRAMES = range(1, 13)


def moving_scene() -> None:
    """A turning parent, a child that is keyed under a parent inverse, a follower by constraint, a still object."""
    parent, still = add("Parent"), add("Still", box("Still"))
    still.location = (5, 0, 0)
    child = add("Child", box(), parent)
    child.matrix_parent_inverse = mathutils.Matrix.Translation((0, 1, 2)) @ mathutils.Matrix.Rotation(0.5, 4, "Y")
    for frame, angle in ((1, 0.0), (12, 6.0)):
        parent.rotation_euler = (0.2, angle, 0.1)
        parent.keyframe_insert("rotation_euler", frame=frame)
        child.location, child.scale = (angle, 1, 0), (1, 1 + angle, -1)
        child.keyframe_insert("location", frame=frame)
        child.keyframe_insert("scale", frame=frame)
    follower = add("Follower", box("Other"))
    follower.constraints.new("COPY_TRANSFORMS").target = child
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = FRAMES[0], FRAMES[-1]


def worlds() -> dict[int, dict[str, np.ndarray]]:
    scene, found = bpy.context.scene, {}
    for frame in FRAMES:
        scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()  # the objects' own matrices lag behind in a new scene
        evaluated = [item.evaluated_get(depsgraph) for item in scene.objects]
        found[frame] = {item.name.split(".")[0]: np.array(item.matrix_world) for item in evaluated}
    return found


def test_sampled_and_written_motion_is_that_of_the_scene() -> None:
    moving_scene()
    expected = worlds()
    bpy.context.scene.frame_set(5)
    graph = sample_animation(read_scene())
    assert bpy.context.scene.frame_current == 5
    clips = graph.components["animation"]
    assert {graph.name[row] for row in clips.rows} == {"Parent", "Child", "Follower"}
    assert all(len(times) == len(FRAMES) for times in clips.columns["times"])
    for place, frame in enumerate(FRAMES):
        local = graph.local.copy()
        for row, matrices in zip(clips.rows, clips.columns["matrices"], strict=True):
            local[row] = matrices[place]
        world = world_matrices(graph.replace(local=local, components={}))
        for row, name in enumerate(graph.name):
            assert relative_gap(world[row], expected[frame][name]) < 1e-5, (frame, name)

    scene = write_scene(graph)
    bpy.context.window.scene = scene
    for frame, world_of in worlds().items():
        for name, world in world_of.items():
            assert relative_gap(world, expected[frame][name]) < 1e-5, (frame, name)


def test_reading_a_scene_or_a_file_samples_on_request(tmp_path: Path) -> None:
    moving_scene()
    told = ReadReport()
    still = read_scene(report=told)
    assert "animation" not in still.components
    assert "Parent: animation: only the place at the present frame is kept" in list(told)
    told, frames = ReadReport(), []
    graph = read_scene(animation=True, report=told, progress=lambda done, total: frames.append((done, total)))
    assert len(graph.components["animation"].rows) == 3
    assert not any("animation" in line for line in told)
    assert frames == [(number, 12) for number in range(1, 13)]
    save_blend(tmp_path / "moving.blend")
    found, _ = read_file(tmp_path / "moving.blend", animation=True)
    assert len(found.components["animation"].rows) == 3


def test_a_still_scene_has_no_animation() -> None:
    add("Still", box())
    assert "animation" not in sample_animation(read_scene(), frames=range(1, 5)).components
