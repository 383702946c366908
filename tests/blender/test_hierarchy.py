"""Local and world matrices for every way in which Blender can hang and turn objects."""

from __future__ import annotations

import bpy
import mathutils
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.blender.helpers import add, assert_same_scene, assert_stands_like_blender, box, relative_gap
from unisg_blender.blender import ReadReport, read_scene, write_scene
from unisg_blender.scene import SceneBuilder, world_matrices

MODES = ("QUATERNION", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX", "AXIS_ANGLE")


def there_and_back() -> None:
    """Read, check against Blender, write, read, compare."""
    graph = read_scene()
    assert_stands_like_blender(graph)
    assert_same_scene(graph, read_scene(write_scene(graph)))


def move(item: bpy.types.Object, seed: int = 0) -> bpy.types.Object:
    rng = np.random.default_rng(seed)
    item.location, item.rotation_euler, item.scale = rng.normal(size=3), rng.normal(size=3), rng.uniform(0.5, 2, 3)
    return item


@pytest.mark.parametrize("mode", MODES)
def test_rotation_modes_and_deltas(mode: str) -> None:
    parent = move(add("Parent"), 1)
    item = move(add("Child", box(), parent), 2)
    item.rotation_mode = mode
    item.rotation_quaternion, item.rotation_axis_angle = (0.8, 0.1, -0.5, 0.3), (2.5, 0.3, 0.4, -0.8)
    item.delta_location, item.delta_scale = (1, -2, 3), (2, -1, 0.5)
    item.delta_rotation_euler, item.delta_rotation_quaternion = (0.4, 0.2, 0.1), (0.9, 0.1, 0.2, -0.3)
    item.matrix_parent_inverse = mathutils.Matrix.Translation((1, 2, 3)) @ mathutils.Matrix.Rotation(1, 4, "X")
    graph = read_scene()
    assert_stands_like_blender(graph)
    written = write_scene(graph).objects["Child.001"]
    assert written.rotation_mode == mode
    for name in ("location", "scale", "delta_location", "delta_scale", "matrix_parent_inverse"):
        np.testing.assert_array_equal(np.array(getattr(written, name)), np.array(getattr(item, name)))


@pytest.mark.parametrize("relative", [False, True])
def test_bone_parent(relative: bool) -> None:
    rig = move(add("Rig", bpy.data.armatures.new("Rig")), 3)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    root = rig.data.edit_bones.new("root")
    root.head, root.tail, root.roll = (0, 0, 1), (0.3, 0.2, 2), 0.4
    tip = rig.data.edit_bones.new("tip")
    tip.head, tip.tail, tip.parent = root.tail, (1, 1, 3), root
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.pose.bones["root"].rotation_quaternion = (0.9, 0.3, 0.1, 0.2)
    rig.pose.bones["tip"].location, rig.pose.bones["tip"].scale = (0.1, 0.2, 0.3), (1, 2, 1.5)
    rig.data.bones["tip"].use_relative_parent = relative
    item = move(add("Tool", box(), rig), 4)
    item.parent_type, item.parent_bone = "BONE", "tip"
    there_and_back()


@pytest.mark.parametrize("kind", ["VERTEX", "VERTEX_3", "LATTICE", "ARMATURE"])
def test_other_parents(kind: str) -> None:
    data = {"LATTICE": bpy.data.lattices, "ARMATURE": bpy.data.armatures}.get(kind)
    parent = move(add("Parent", box() if data is None else data.new("Data")), 5)
    item = move(add("Child", box("Small", 0.2), parent), 6)
    item.parent_type = kind
    item.parent_vertices = (1, 4, 6)
    there_and_back()


def test_constraints_keep_the_evaluated_place() -> None:
    target, item = move(add("Target"), 7), move(add("Follower", box()), 8)
    move(add("Under", box("Other"), item), 9)
    constraint = item.constraints.new("COPY_TRANSFORMS")
    constraint.target = target
    bpy.context.view_layer.update()
    graph = read_scene(report=(report := ReadReport()))
    assert_stands_like_blender(graph)
    assert len(graph.components["world"].rows) == 1
    assert any("Follower: constraints" in line for line in report)
    assert relative_gap(graph["Follower"].local, np.array(item.matrix_basis)) < 1e-6
    again = read_scene(write_scene(graph))
    for name in ("Follower", "Under"):
        written = next(entity for entity in map(again.__getitem__, range(3)) if entity.name.startswith(name))
        assert relative_gap(written.world, graph[name].world) < 1e-5


@pytest.mark.parametrize("scale", [(0, 0, 0), (1, 0, 2), (-1, 1, 1), (-1, -1, -1), (1, 1e-4, 1), (3, 2, -0.1)])
def test_mirrors_and_zero_scale(scale: tuple[float, float, float]) -> None:
    parent = move(add("Parent"), 10)
    parent.scale = scale
    child = move(add("Child", box(), parent), 11)
    move(add("Grandchild", box("Other"), child), 12)
    there_and_back()


def test_shear_under_a_parent_and_at_a_root() -> None:
    shear = np.eye(4)
    shear[0, 1], shear[2, 0] = 0.7, -0.3
    builder = SceneBuilder()
    root = builder.add("Root", uid="r", local=shear)
    builder.add("Child", uid="c", parent=root, local=shear @ shear)
    graph = builder.build()
    again = read_scene(write_scene(graph))
    assert_same_scene(graph, again)
    assert len(again) == 2


@pytest.mark.parametrize("mode", ["XYZ", "QUATERNION"])
def test_places_that_are_no_numbers_are_left_out_and_told(mode: str) -> None:
    parent = add("Parent", box())
    child = move(add("Child", box(), parent), 3)
    parent.location.x, parent.rotation_mode = float("nan"), mode
    bpy.context.view_layer.update()
    graph = read_scene(report=(report := ReadReport()))
    assert np.isfinite(world_matrices(graph)).all()
    assert "Parent: its transform is no finite matrix; left out" in list(report)
    assert relative_gap(graph["Child"].local, np.array(child.matrix_basis)) < 1e-6
    again = read_scene(write_scene(graph))
    assert np.isfinite(world_matrices(again)).all()


def test_disabled_objects_stand_where_their_parents_put_them() -> None:
    parent = move(add("Parent"), 13)
    item = move(add("Child", box(), parent), 14)
    item.hide_viewport = True
    bpy.context.view_layer.update()
    expected = np.array(parent.matrix_world) @ np.array(item.matrix_basis)
    assert relative_gap(read_scene()["Child"].world, expected) < 1e-6


def test_a_parent_in_another_scene() -> None:
    other = bpy.data.scenes.new("Other")
    parent = move(bpy.data.objects.new("Parent", None), 15)
    other.collection.objects.link(parent)
    item = move(add("Child", box(), parent), 16)
    bpy.context.view_layer.update()
    graph = read_scene()
    assert graph.name == ("Child",)
    assert relative_gap(graph["Child"].world, np.array(item.matrix_world)) < 1e-5


def test_a_scene_that_is_not_the_current_one() -> None:
    other = bpy.data.scenes.new("Other")
    parent, child = move(bpy.data.objects.new("A", None), 17), move(bpy.data.objects.new("B", box()), 18)
    child.parent = parent
    for item in (parent, child):
        other.collection.objects.link(item)
    child.constraints.new("LIMIT_LOCATION").use_min_x = True
    world = world_matrices(read_scene(other))
    bpy.context.window.scene = other
    bpy.context.view_layer.update()
    assert relative_gap(world[1], np.array(child.matrix_world)) < 1e-5


AFFINE = st.lists(st.floats(-2, 2, width=32), min_size=12, max_size=12).map(
    lambda numbers: np.vstack([np.array(numbers).reshape(3, 4), [0, 0, 0, 1]])
)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(AFFINE, st.integers(-1, 5)), min_size=1, max_size=8))
def test_any_matrices_in_any_hierarchy(rows: list[tuple[np.ndarray, int]]) -> None:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    builder = SceneBuilder()
    for number, (matrix, above) in enumerate(rows):
        builder.add(f"Object {number}", uid=str(number), parent=min(above, number - 1), local=matrix)
    graph = builder.build()
    again = read_scene(write_scene(graph))
    assert set(again.uid) == set(graph.uid)
    for row, uid in enumerate(graph.uid):
        assert np.abs(again.local[again.row_of_uid[uid]] - graph.local[row]).max() < 1e-5 * max(
            1, np.abs(graph.local[row]).max()
        )
