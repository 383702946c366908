"""Ground truth by Blender's passes against rays cast at triangles: instances, modifiers, hidden and mirrored things."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("bpy")

import bpy

from tests.blender.ray_casts import cast
from unisg_blender.blender import open_file, read_scene, save_blend
from unisg_blender.blender.render import truth as truth_module
from unisg_blender.blender.render.photograph import rendered_rows, show_as_rendered
from unisg_blender.blender.render.truth import Truth, truth_stage
from unisg_blender.dataset.export.realized_instances import realize_objects
from unisg_blender.geometry.camera_view import CameraView, looking
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.spatial.structure.scan import world_triangles
from unisg_blender.worlds import cubes

pytestmark = pytest.mark.slow
SIZE = (56, 48)


def many_kinds() -> None:
    """A scene with instances, a modifier, hidden things, a mirrored one, and one that only cameras do not see."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.mesh.primitive_plane_add(size=8)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.5), rotation=(0, 0, 0.5), scale=(1, -0.5, 1))
    cube = bpy.context.object
    bpy.ops.mesh.primitive_monkey_add(location=(1.5, 0.3, 1))
    bpy.context.object.modifiers.new("smooth", "SUBSURF").render_levels = 2
    bpy.context.object.modifiers["smooth"].levels = 0
    bpy.ops.mesh.primitive_cube_add(size=4, location=(0, 0, 2))
    bpy.context.object.hide_render = True
    bpy.ops.mesh.primitive_cube_add(size=4, location=(0, 0, 2))
    bpy.context.object.visible_camera = False
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.4, location=(-1.5, 0, 0.4))
    bpy.context.object.hide_viewport = True
    parts = bpy.data.collections.new("parts")
    copy = bpy.data.objects.new("inner", cube.data)
    copy.scale = (0.3, 0.3, 0.9)
    parts.objects.link(copy)
    for place in range(3):
        shown = bpy.data.objects.new("shown", None)
        shown.instance_type, shown.instance_collection = "COLLECTION", parts
        shown.location, shown.rotation_euler = (place - 1.5, -1.4, 0.45), (0.1, 0, place)
        bpy.context.scene.collection.objects.link(shown)


def check(graph: SceneGraph, shown: np.ndarray, view: CameraView, truth: Truth) -> int:
    """Compare with rays; returns how many pixels were compared."""
    triangles, owner = world_triangles(graph)
    kept = shown[owner]
    lines, columns = (part.ravel() for part in np.mgrid[0 : view.size[1], 0 : view.size[0]])
    who, depth = cast(view, triangles[kept], owner[kept], columns, lines)
    who, depth = who.reshape(truth.row.shape), depth.reshape(truth.row.shape)
    edge = np.zeros(who.shape, bool)
    for axis in (0, 1):
        differs = np.diff(who, axis=axis) != 0
        edge |= np.pad(differs, [(1, 0) if each == axis else (0, 0) for each in (0, 1)])
        edge |= np.pad(differs, [(0, 1) if each == axis else (0, 0) for each in (0, 1)])
    assert (truth.row == who)[~edge].all()
    flat = ~edge & (who >= 0)
    steep = np.maximum(*[np.abs(gradient) for gradient in np.gradient(np.where(np.isfinite(depth), depth, 1e3))])
    flat &= steep < 0.2  # where a hundredth of a pixel is less than a millimetre
    assert np.abs(truth.depth[flat] - depth[flat]).max() < 0.001
    np.testing.assert_allclose(np.linalg.norm(truth.normal[truth.row >= 0], axis=-1), 1, atol=1e-4)
    return int((~edge).sum())


@pytest.mark.parametrize("orthographic", [False, True])
def test_no_wrong_pixel_but_at_edges(tmp_path: Path, orthographic: bool) -> None:
    many_kinds()
    save_blend(tmp_path / "kinds.blend")
    open_file(tmp_path / "kinds.blend")
    show_as_rendered(bpy.context.scene)
    graph = realize_objects(read_scene(bpy.context.scene))[0]
    shown = rendered_rows(graph, bpy.context.scene)
    seen = looking("x", np.array([1.0, -4, 3]), np.array([0, 0, 0.4]), SIZE, 1.0)
    view = CameraView("x", seen.world, SIZE, 12.0, (30.0, 22.0), orthographic=True) if orthographic else seen
    before = len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.cameras), len(bpy.data.scenes)
    with truth_stage(graph, shown) as stage:
        truth = stage.render(view)
    assert (len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.cameras), len(bpy.data.scenes)) == before
    assert check(graph, shown, view, truth) > 1500
    names = {graph.name[row] for row in np.unique(truth.row) if row >= 0}
    assert {"Plane", "Cube", "Suzanne"} <= names
    assert not {"Cube.001", "Cube.002"} & names
    assert sum(name.startswith("inner") for name in (graph.name[row] for row in np.unique(truth.row) if row >= 0)) == 3


def test_numbers_do_not_wrap(monkeypatch: pytest.MonkeyPatch) -> None:
    builder, mesh = SceneBuilder("many"), cubes(0).meshes[0]
    for number in range(1000):
        place = np.eye(4)
        place[:3, 3] = number % 40, number // 40, 0
        place[:3, :3] *= 0.5 / np.ptp(mesh.points, axis=0).max()
        builder.add(f"thing {number}", uid=f"uid {number}", mesh=mesh, local=place, category=f"kind {number % 300}")
    graph = builder.build()
    world = np.eye(4)
    world[:3, 3] = 19.5, 12, 10
    view = CameraView("above", world, (168, 104), 4.0, (84, 52), orthographic=True)
    with truth_stage(graph, np.ones(len(graph), bool)) as stage:
        truth = stage.render(view)
        monkeypatch.setattr(truth_module, "MOST", 30)  # two digits
        again = stage.render(view)
    assert set(np.unique(truth.row)) - {-1} == set(range(1000))
    assert (truth.row == again.row).all()
