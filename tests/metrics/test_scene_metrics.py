from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.metrics.scene_validity import (
    counted_objects,
    find_collisions,
    measure_scene,
    outside_room,
    overlapping_categories,
    summarise,
    support_levels,
)
from unisg_blender.metrics.support_gaps import support_gaps
from unisg_blender.scene import Relation

from . import hand_made
from .hand_made import Scene, box_mesh, table_mesh


def names_of(graph, pairs):
    return {tuple(sorted((graph.name[a], graph.name[b]))) for a, b in pairs}


@pytest.mark.parametrize(("overlap", "found"), [(0.019, False), (0.021, True), (-0.01, False)])
def test_two_centimetres_are_the_limit_for_big_things(overlap, found):
    scene = Scene()
    scene.box("a", (0.5, 0.5, 0.5), (0, 0, 0))
    scene.box("b", (0.5, 0.5, 0.5), (0.5 - overlap, 0, 0))
    result = find_collisions(scene.build())
    assert (len(result.pairs) == 1) == found
    if found:
        np.testing.assert_allclose(result.depth, [overlap], atol=1e-6)


@pytest.mark.parametrize(("overlap", "found"), [(0.009, False), (0.011, True)])
def test_one_centimetre_is_the_limit_for_small_things(overlap, found):
    scene = Scene()
    scene.box("cup", (0.08, 0.08, 0.08), (0, 0, 0))
    scene.box("wardrobe", (1, 1, 2), (0.54 - overlap, 0, 0))
    assert (len(find_collisions(scene.build()).pairs) == 1) == found


def test_thin_things_in_one_place_collide():
    scene = Scene()
    scene.box("scalpel", (0.01, 0.16, 0.006), (0, 0, 0))
    scene.box("forceps", (0.16, 0.01, 0.006), (0, 0, 0))
    scene.box("leaning", (0.01, 0.16, 0.006), (1, 0, 0))
    scene.box("just under", (0.01, 0.16, 0.006), (1, 0, 0.004))
    assert names_of(scene.build(), find_collisions(scene.build()).pairs) == {("forceps", "scalpel")}


def test_a_turned_box_is_tested_by_its_own_axes():
    scene = Scene()
    scene.box("a", (1, 1, 1), (0, 0, 0))
    scene.box("corner misses", (1, 1, 1), (1.05, 1.05, 0, np.pi / 4))
    scene.box("corner hits", (1, 1, 1), (-1.1, 0, 0, np.pi / 4))
    graph = scene.build()
    result = find_collisions(graph)
    assert names_of(graph, result.pairs) == {("a", "corner hits")}
    np.testing.assert_allclose(result.depth, [0.5 + np.sqrt(0.5) - 1.1], atol=1e-6)


def test_a_stool_under_a_table_collides_with_the_whole_box_only():
    scene = Scene()
    scene.box("table", None, (0, 0, 0), mesh=table_mesh(), category="Table")
    scene.box("stool", (0.4, 0.4, 0.5), (0, 0, 0), category="Stool")
    graph = scene.build()
    assert len(find_collisions(graph).pairs) == 0
    assert names_of(graph, find_collisions(graph, parts=False).pairs) == {("stool", "table")}
    allowed = overlapping_categories([graph])
    assert allowed == {("Stool", "Table")}
    assert len(find_collisions(graph, parts=False, allowed=allowed).pairs) == 0


def test_what_carries_a_thing_is_no_collision_but_the_next_thing_down_is():
    scene = Scene()
    box = scene.box("crate", (0.6, 0.6, 0.4), (0, 0, 0))
    inner = scene.box("dish", (0.3, 0.3, 0.1), (0, 0, 0.1), parent=box)
    scene.box("tool", (0.1, 0.1, 0.1), (0, 0, 0.02), parent=inner)
    graph = scene.build()
    assert names_of(graph, find_collisions(graph).pairs) == {("crate", "tool")}


def test_a_relation_excuses_a_pair_too():
    scene = Scene()
    scene.box("crate", (0.6, 0.6, 0.4), (0, 0, 0))
    scene.box("ball", (0.3, 0.3, 0.3), (0, 0, 0), relation=("inside", "crate"))
    scene.box("other", (0.3, 0.3, 0.3), (0, 0, 0), relation=("beside", "crate"))
    graph = scene.build()
    assert names_of(graph, find_collisions(graph).pairs) == {("crate", "other"), ("ball", "other")}


def test_walls_are_met_but_not_counted():
    scene = Scene()
    scene.box("wall", (0.1, 4, 3), (3.05, 0, 0), category="Wall")
    scene.box("other wall", (6, 0.1, 3), (0.1, 2.0, 0), category="Wall")
    scene.box("bed", (1, 2, 0.5), (2.6, 0, 0))
    graph = scene.build()
    assert names_of(graph, find_collisions(graph).pairs) == {("bed", "wall")}
    assert [graph.name[row] for row in np.flatnonzero(counted_objects(graph))] == ["bed"]


@pytest.mark.parametrize("gap", [0.0, 0.015, 0.5, -0.03, -0.3])
def test_gap_to_the_floor(gap):
    scene = Scene()
    scene.box("a", (0.4, 0.4, 0.4), (1, 0.5, gap))
    graph = scene.build()
    np.testing.assert_allclose(support_gaps(graph)[graph.row("a")], gap, atol=1e-6)
    assert measure_scene(graph).off_support[graph.row("a")] == (abs(gap) > 0.02)


def test_gap_on_a_table_and_on_a_shelf_board():
    scene = Scene()
    table = scene.box("table", None, (0, 0, 0, 0.3), mesh=table_mesh())
    surfaces = box_mesh(*[((1, 0.3, 0.02), (0, 0, z)) for z in (0.1, 0.5, 0.9)])
    shelf = scene.box("shelf", None, (2, 1, 0), mesh=surfaces)
    scene.box("cup", (0.08, 0.08, 0.1), (0.5, 0.3, 0.76), parent=table)
    scene.box("beside", (0.08, 0.08, 0.1), (0.7, 0, 0.75), parent=table)
    scene.box("book", (0.2, 0.2, 0.2), (0, 0, 0.515), parent=shelf)
    graph = scene.build()
    gaps = dict(zip(graph.name, support_gaps(graph), strict=True))
    np.testing.assert_allclose([gaps["cup"], gaps["book"], gaps["table"]], [0.01, -0.005, 0.0], atol=1e-6)
    assert gaps["beside"] == np.inf
    assert measure_scene(graph).off_support[graph.row("beside")]


def test_without_a_hierarchy_whatever_lies_under_carries():
    scene = Scene()
    for name, z in (("lower", 0.0), ("upper", 0.4), ("lost", 1.2)):
        scene.box(name, (0.4, 0.4, 0.4), (0, 0, z), parent=-1)
    graph = scene.build()
    gaps = dict(zip(graph.name, support_gaps(graph), strict=True))
    np.testing.assert_allclose([gaps["lower"], gaps["upper"], gaps["lost"]], [0.0, 0.0, 0.4], atol=1e-6)


def test_an_empty_between_a_thing_and_its_support_is_looked_through():
    scene = Scene()
    group = scene.builder.add("group", uid="group", parent=scene.floor)
    scene.box("a", (0.4, 0.4, 0.4), (1, 0.5, 0.1), parent=group)
    graph = scene.build()
    np.testing.assert_allclose(support_gaps(graph)[graph.row("a")], 0.1, atol=1e-6)


def test_what_hangs_is_measured_to_what_it_hangs_from():
    scene = Scene()
    wall = scene.box("wall", (0.1, 4, 3), (3.05, 0, 0), category="Wall")
    scene.box("clock", (0.02, 0.3, 0.3), (-0.06, 0, 2), parent=wall, relation=("hangs_from", "wall"))
    scene.box("ghost", (0.02, 0.3, 0.3), (-0.16, 1, 2), parent=wall, relation=("hangs_from", "wall"))
    graph = scene.build()
    gaps = dict(zip(graph.name, support_gaps(graph), strict=True))
    np.testing.assert_allclose([gaps["clock"], gaps["ghost"]], [0.0, 0.1], atol=1e-6)
    assert list(measure_scene(graph).off_support[[graph.row("clock"), graph.row("ghost")]]) == [False, True]


def test_outside_is_the_farthest_corner():
    scene = Scene()
    scene.box("in", (1, 1, 1), (2.5, 1.5, 0))
    scene.box("out", (1, 1, 1), (2.8, 0, 0))
    scene.box("far", (1, 1, 1), (5, 4, 0))
    graph = scene.build()
    reach = dict(zip(graph.name, outside_room(graph), strict=True))
    np.testing.assert_allclose([reach["in"], reach["out"], reach["far"]], [0.0, 0.3, np.hypot(2.5, 2.5)], atol=1e-6)


def test_the_corner_of_an_l_shaped_room_pokes_into_things():
    corner = [(-2, -2), (2, -2), (2, 0), (0, 0), (0, 2), (-2, 2)]
    from unisg_blender.scene import mesh_from_faces

    floor = mesh_from_faces("floor", np.column_stack([np.array(corner, float), np.zeros(6)]), [list(range(6))])
    scene = Scene(floor)
    scene.box("over the corner", (0.4, 0.4, 1), (-0.1, -0.1, 0, np.pi / 4))
    scene.box("clear", (0.4, 0.4, 1), (-1, 1, 0))
    graph = scene.build()
    reach = dict(zip(graph.name, outside_room(graph), strict=True))
    np.testing.assert_allclose(reach["over the corner"], 0.2 - np.hypot(0.1, 0.1), atol=1e-6)
    assert reach["clear"] == 0


def test_levels_and_summary():
    scene = Scene()
    table = scene.box("table", None, (0, 0, 0), mesh=table_mesh())
    tray = scene.box("tray", (0.4, 0.3, 0.02), (0, 0, 0.75), parent=table)
    scene.box("tool", (0.15, 0.01, 0.01), (0, 0, 0.02), parent=tray)
    scene.box("floating", (0.15, 0.1, 0.1), (0, 0.1, 0.5), parent=tray)
    graph = scene.build()
    levels = dict(zip(graph.name, support_levels(graph), strict=True))
    assert levels == {"floor": 0, "table": 1, "tray": 2, "tool": 3, "floating": 3}
    row = summarise([measure_scene(graph), measure_scene(graph)])
    assert (row["scenes"], row["objects"], row["off_support"], row["colliding"]) == (2, 8, 0.25, 0)
    assert (row["faults"], row["scenes_without_fault"], row["level"]) == (0.25, 0.0, 3)


def test_a_scene_without_floor_or_things():
    from unisg_blender.scene import SceneBuilder

    empty = SceneBuilder().build()
    assert summarise([measure_scene(empty)])["objects"] == 0
    builder = SceneBuilder()
    builder.add("a", uid="a", mesh=box_mesh(((1, 1, 1), (0, 0, 0))))
    report = measure_scene(builder.build())
    assert not report.outside.any()
    assert report.off_support.all(), "nothing carries it"


def test_relations_say_what_carries_where_the_hierarchy_is_flat():
    scene = Scene()
    scene.box("left", (0.3, 0.3, 0.3), (0, 0, 0))
    scene.box("right", (0.3, 0.3, 0.3), (0.4, 0, 0))
    scene.builder.add(
        "bridge", uid="bridge", parent=scene.floor, local=hand_made.at(0.2, 0, 0.31),
        mesh=box_mesh(((0.5, 0.2, 0.1), (0, 0, 0))), category="Box",
        relations=(Relation("on_top_of", "left"), Relation("on_top_of", "right")),
    )  # fmt: skip
    graph = scene.build()
    row = graph.row("bridge")
    np.testing.assert_allclose(support_gaps(graph)[row], 0.01, atol=1e-6)
    assert support_levels(graph)[row] == 2


def test_things_that_carry_each_other_end():
    scene = Scene()
    scene.box("a", (0.3, 0.3, 0.3), (0, 0, 0), relation=("on_top_of", "b"))
    scene.box("b", (0.3, 0.3, 0.3), (0, 0, 0.3), relation=("on_top_of", "a"))
    assert measure_scene(scene.build()).level.max() >= 1


def test_flat_things_collide_by_the_stricter_limit_only():
    scene = Scene()
    scene.box("scalpel", (0.01, 0.16, 0.006), (0, 0, 0))
    scene.box("forceps", (0.16, 0.01, 0.006), (0, 0, 0))
    scene.box("crate", (0.5, 0.5, 0.5), (2, 0, 0))
    scene.box("other crate", (0.5, 0.5, 0.5), (2.4, 0, 0))
    graph = scene.build()
    report = measure_scene(graph)
    crates = [graph.row("crate"), graph.row("other crate")]
    tools = [graph.row("scalpel"), graph.row("forceps")]
    assert report.colliding[crates].all()
    assert not report.colliding[tools].any()
    assert report.overlapping[crates + tools].all()
    row = summarise([report])
    assert (row["colliding"], row["overlapping"], row["faults"]) == (0.5, 1.0, 1.0)
