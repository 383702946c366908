"""What an object hangs on, also in states that Blender's interface does not name."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
import pytest

from tests.blender.helpers import add, assert_stands_like_blender, box
from unisg_blender.blender import ReadReport, read_scene, write_scene
from unisg_blender.scene import SceneBuilder, table


def rig(name: str) -> bpy.types.Object:
    """An armature with one bone."""
    item = add(name, bpy.data.armatures.new(name))
    bpy.context.view_layer.objects.active = item
    bpy.ops.object.mode_set(mode="EDIT")
    item.data.edit_bones.new("foot").tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    return item


def curve(name: str) -> bpy.types.Object:
    item = add(name, bpy.data.curves.new(name, "CURVE"))
    item.data.splines.new("POLY").points.add(3)
    return item


MAKE: dict[str, Callable[[str], bpy.types.Object]] = {
    "ARMATURE": rig,
    "MESH": lambda name: add(name, box(name)),
    "CURVE": curve,
    "LATTICE": lambda name: add(name, bpy.data.lattices.new(name)),
    "EMPTY": add,
}
KINDS = [
    ("ARMATURE", "BONE"), ("ARMATURE", "ARMATURE"), ("MESH", "VERTEX"), ("MESH", "VERTEX_3"), ("LATTICE", "LATTICE"),
]  # fmt: skip


@pytest.mark.parametrize("new", MAKE)
@pytest.mark.parametrize(("old", "kind"), KINDS)
def test_a_kind_of_parenting_that_the_new_parent_has_not(old: str, kind: str, new: str) -> None:
    """Blender keeps the kind when the parent is exchanged, and shows the object under the new one as a whole."""
    first, second, shoe = MAKE[old]("first"), MAKE[new]("second"), add("shoe", box("shoe"))
    second.location, shoe.location = (1, 2, 3), (0, 0, 2)
    shoe.parent, shoe.parent_type = first, kind
    shoe.parent_bone = "foot" if kind == "BONE" else ""
    shoe.parent = second
    report = ReadReport()
    graph = read_scene(report=report)
    assert_stands_like_blender(graph)
    named = new == "ARMATURE" if kind == "BONE" else shoe.parent_type != ""
    assert ("parenting" in graph.components) == named
    again = read_scene(write_scene(graph))
    np.testing.assert_allclose(again.world[again.row("shoe.001")], graph.world[graph.row("shoe")], atol=1e-6)
    assert again.name[again.parent[again.row("shoe.001")]] == "second.001"


def test_a_missing_bone_and_vertices_beyond_the_mesh_hang_on_the_whole() -> None:
    armature, mesh = rig("rig"), add("leg", box("leg"))
    for name, above, kind in (("on bone", armature, "BONE"), ("on corner", mesh, "VERTEX_3")):
        item = add(name, box(name), above)
        item.parent_type, item.location = kind, (1, 0, 0)
    bpy.data.objects["on bone"].parent_bone = "gone"
    bpy.data.objects["on corner"].parent_vertices = (0, 1, 99)
    graph = read_scene()
    assert_stands_like_blender(graph)
    report = ReadReport()
    assert read_scene(write_scene(graph, report=report)).world.shape == graph.world.shape
    for name in ("on bone", "on corner"):
        assert f"{name}.001: hangs on its parent as a whole, not on a bone or vertex" in list(report)


def test_a_kind_that_blender_does_not_know_is_told() -> None:
    builder = SceneBuilder()
    builder.add("above", uid="a")
    builder.add("below", uid="b", parent=0)
    parts = table([1], kind=["TENTACLE"], bone=[""], vertices=np.zeros((1, 3), np.int32), frame=np.eye(4)[None])
    graph, report = builder.build().with_component("parenting", parts), ReadReport()
    again = read_scene(write_scene(graph, report=report))
    assert again.parent.tolist() == [-1, 0]
    assert "below: hangs on its parent as a whole, not on a bone or vertex" in list(report)


@pytest.mark.parametrize("target", ["itself", "its child", "each other"])
def test_circles_of_constraints_stand_where_blender_puts_them(target: str) -> None:
    first, second = add("first", box()), add("second", box())
    first.location, second.location = (1, 0, 0), (0, 1, 0)
    first.constraints.new("COPY_LOCATION").target = first if target == "itself" else second
    if target == "its child":
        second.parent = first
    elif target == "each other":
        second.constraints.new("COPY_ROTATION").target = first
    assert_stands_like_blender(read_scene())


def test_what_stands_beyond_all_numbers_is_told_and_stays_at_its_parent() -> None:
    far = add("far", box())
    far.scale = (1e29, 1, 1)
    below = add("below", box(), far)
    below.location, below.scale = (1e29, 0, 0), (1e29, 1, 1)
    none = add("none", box())
    none.location = (float("nan"), 0, 0)
    report = ReadReport()
    graph = read_scene(report=report)
    assert np.isfinite(graph.world).all()
    assert graph["far"].world[0, 0] == pytest.approx(1e29)
    told = [line for line in report if line.endswith("its transform is no finite matrix; left out")]
    assert [line.split(":")[0] for line in told] == ["below", "none"]


@pytest.mark.parametrize("kind", ["VERTEX", "VERTEX_3"])
def test_what_hangs_on_corners_and_is_held_by_a_constraint_stands_where_blender_has_it(kind: str) -> None:
    """Where a constraint decides, the frame that the corners make cannot be told from what is seen."""
    leg, goal = add("leg", box("leg")), add("goal")
    leg.location, goal.location = (1, 2, 3), (5, 5, 5)
    plain, held = add("plain", box("plain"), leg), add("held", box("held"), leg)
    for item in (plain, held):
        item.parent_type, item.parent_vertices, item.location = kind, (0, 3, 5), (0.5, 0, 0)
    held.constraints.new("COPY_LOCATION").target = goal
    bpy.context.view_layer.update()
    graph = read_scene()
    assert_stands_like_blender(graph)
    parenting = graph.components["parenting"]
    frames = dict(zip(parenting.rows.tolist(), parenting.columns["frame"], strict=True))
    np.testing.assert_allclose(frames[graph.row("held")], np.eye(4))
    assert not np.allclose(frames[graph.row("plain")], np.eye(4))
