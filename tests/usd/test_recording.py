"""Recordings: playback and moving by hand into a USD file, and back onto the scene; the operators around it."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

from unisg_blender import UniSGError  # noqa: E402
from unisg_blender.blender import read_scene  # noqa: E402
from unisg_blender.blender.motion.scene_recording import SceneRecorder, needed_keys, record_playback, replay  # noqa: E402
from unisg_blender.scene.properties import RELATIONS  # noqa: E402
from unisg_blender.usd import read_usd, write_usd  # noqa: E402


@pytest.fixture
def cubes() -> list:
    """A parent and a child, both with identities of their own."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    mesh = bpy.data.meshes.new("Box")
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    mesh.from_pydata(corners, [], [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    items = []
    for name in ("Base", "Arm"):
        item = bpy.data.objects.new(name, mesh)
        item["unisg_uid"] = name
        bpy.context.scene.collection.objects.link(item)
        items.append(item)
    items[1].parent = items[0]
    items[1].location = (0, 0, 1)
    bpy.context.view_layer.update()
    return items


def world(item: object) -> np.ndarray:
    return np.array(item.matrix_world)


def test_playback_survives_the_file(cubes: list, tmp_path: Path) -> None:
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 20
    base, arm = cubes
    for frame, x in ((1, 0.0), (20, 3.0)):
        base.location.x = x
        base.keyframe_insert("location", frame=frame)
        arm.rotation_euler.z = x
        arm.keyframe_insert("rotation_euler", frame=frame)
    expected = {}
    for frame in range(1, 21):
        scene.frame_set(frame)
        expected[frame] = world(base), world(arm)
    write_usd(record_playback(scene), tmp_path / "played.usdc")
    for item in cubes:
        item.animation_data_clear()
        item.location = (9, 9, 9)
    assert replay(read_usd(tmp_path / "played.usdc"), scene) == 2
    for frame, (first, second) in expected.items():
        scene.frame_set(frame)
        np.testing.assert_allclose(world(base), first, atol=1e-5)
        np.testing.assert_allclose(world(arm), second, atol=1e-5)


def test_moved_by_hand(cubes: list, tmp_path: Path) -> None:
    scene, recorder = bpy.context.scene, SceneRecorder()
    arm = cubes[1]
    rate = scene.render.fps
    seen = {}
    for step in range(60):
        if 10 <= step < 40:
            arm.location.x = (step - 9) / 10
            arm.rotation_euler.z = (step - 9) / 20
        bpy.context.view_layer.update()
        recorder.sample(scene, step / rate)
        seen[step] = world(arm)
    graph = recorder.recorded(read_scene(scene), millimetres=1.0, degrees=0.2)
    found = graph.components["recording"]
    assert [graph.name[row] for row in found.rows] == ["Arm"]
    assert len(found.columns["times"][0]) < 20  # of 31 that moved: a steady turn needs few
    write_usd(graph, tmp_path / "hand.usda")
    replay(read_usd(tmp_path / "hand.usda"), scene)
    for step, expected in seen.items():
        scene.frame_set(step)
        assert np.linalg.norm(world(arm)[:3, 3] - expected[:3, 3]) < 0.0015
        np.testing.assert_allclose(world(arm)[:3, :3], expected[:3, :3], atol=0.005)


def test_growing_things_keep_all_keys() -> None:
    matrices = np.tile(np.eye(4), (5, 1, 1)) * np.linspace(1, 2, 5)[:, None, None]
    matrices[:, 3] = (0, 0, 0, 1)
    assert needed_keys(np.arange(5.0), matrices, 1.0, 1.0).tolist() == [0, 1, 2, 3, 4]


@pytest.mark.parametrize(("millimetres", "degrees"), [(0.0, 1.0), (1.0, 0.0), (-1.0, 1.0), (1.0, -1.0)])
def test_without_a_tolerance_all_keys_stay(millimetres: float, degrees: float) -> None:
    matrices = np.tile(np.eye(4), (5, 1, 1))
    matrices[:, 0, 3] = np.arange(5)
    assert needed_keys(np.arange(5.0), matrices, 1.0, 1.0).tolist() == [0, 4]
    assert needed_keys(np.arange(5.0), matrices, millimetres, degrees).tolist() == [0, 1, 2, 3, 4]
    assert needed_keys(np.arange(2.0), matrices[:2], 1.0, 1.0).tolist() == [0, 1]


def test_nothing_to_replay(cubes: list) -> None:
    with pytest.raises(UniSGError, match="no recording"):
        replay(read_scene())
    base = cubes[0]
    recorder = SceneRecorder()
    for step in range(3):
        base.location.x = step
        bpy.context.view_layer.update()
        recorder.sample(bpy.context.scene, float(step))
    graph = recorder.recorded(read_scene())
    base["unisg_uid"] = "another"
    with pytest.raises(UniSGError, match="identities"):
        replay(graph)


@pytest.fixture
def extension() -> object:
    """The operators of this room, registered as the extension does it."""
    root = Path(__file__).parents[2]
    sys.path.insert(0, str(root.parent))
    modules = [
        importlib.import_module(f"{root.name}.operators.{name}") for name in ("convert", "relations", "recording")
    ]
    for module in modules:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)
    yield bpy.ops.unisg
    for module in modules:
        for cls in module.CLASSES:
            bpy.utils.unregister_class(cls)
    sys.path.remove(str(root.parent))


def test_operators(cubes: list, extension: object, tmp_path: Path) -> None:
    scene = bpy.context.scene
    assert extension.relations() == {"FINISHED"}
    assert "on_top_of" in cubes[1][RELATIONS]
    path = tmp_path / "scene.usdc"
    assert extension.convert(filepath=str(path)) == {"FINISHED"}
    assert set(read_usd(path).components["relations"].columns["kind"]) >= {"on_top_of"}
    with pytest.raises(RuntimeError, match="ends in"):
        extension.convert(filepath=str(tmp_path / "scene.txt"))
    scene.frame_end = 3
    for frame in (1, 3):
        cubes[0].location.x = frame
        cubes[0].keyframe_insert("location", frame=frame)
    assert extension.record(filepath=str(tmp_path / "film.usdc")) == {"FINISHED"}
    cubes[0].animation_data_clear()
    assert extension.replay(filepath=str(tmp_path / "film.usdc")) == {"FINISHED"}
    scene.frame_set(3)
    assert cubes[0].location.x == pytest.approx(3)
