from __future__ import annotations

import numpy as np
import pytest

from tests.metrics.hand_made import Scene, box_mesh, table_mesh
from unisg_blender.experiments.rooms.cases import case_of, hole_of, without
from unisg_blender.experiments.rooms.completion import most_common, pose_error
from unisg_blender.geometry.planar import footprint_gap
from unisg_blender.metrics.requested_relations import is_beside, is_on, place_of

KNOWN = ("Table", "Cup", "Box")


def room():
    scene = Scene()
    table = scene.box("table", None, (0.5, 0.2, 0, np.pi / 2), category="Table", mesh=table_mesh())
    for number in range(3):
        scene.box(f"cup {number}", (0.08, 0.08, 0.1), (0.2 * number - 0.2, 0.1, 0.75), category="Cup", parent=table)
    scene.box("crate", (0.4, 0.4, 0.3), (-1.5, 0, 0), category="Box", relation=("on_top_of", "floor"))
    return scene.build()


def test_a_case_keeps_the_structure_and_asks_for_all_else():
    case = case_of(room(), KNOWN)
    assert case.wanted == {"Table": 1, "Cup": 3, "Box": 1}
    assert case.shell.name == ("floor",)
    assert [asset.category for asset in case.assets["Cup"]] == ["Cup"] * 3
    assert case_of(room(), ("Chair",)) is None


def test_what_the_model_does_not_know_stays():
    case = case_of(room(), ("Cup",))
    assert set(case.shell.name) == {"floor", "table", "crate"}


def test_what_stands_on_something_goes_with_it():
    graph = room()
    rest = without(graph, np.array([name == "table" for name in graph.name]))
    assert set(rest.name) == {"floor", "crate"}


def test_a_hole_asks_for_a_removed_thing_whose_support_is_still_there():
    graph, seen = room(), set()
    for seed in range(40):
        hole = hole_of(graph, KNOWN, seed)
        if hole is None:
            continue
        seen.add(hole.category)
        assert hole.support in hole.rest.uid
        gone = [name for name in graph.name if name not in hole.rest.name]
        alike = [graph.row(name) for name in gone if graph.category_name(graph.row(name)) == hole.category]
        true = [place_of(graph, row) for row in alike]
        assert min(np.abs(hole.places[0] - place).max() for place in true) < 1e-9
        assert len(hole.places) <= len(true)
        assert not hole.neighbour or hole.neighbour in hole.rest.uid
    assert seen == {"Table", "Cup", "Box"}


def test_the_same_seed_gives_the_same_hole():
    one, two = hole_of(room(), KNOWN, 3), hole_of(room(), KNOWN, 3)
    assert one.rest.name == two.rest.name
    np.testing.assert_array_equal(one.places, two.places)


def test_the_place_of_a_thing_is_the_middle_of_its_bottom():
    scene = Scene()
    scene.box("odd", None, (1, 2, 0.5, np.pi / 2), mesh=box_mesh(((0.4, 0.2, 0.3), (0.5, 0, 0.1))))
    graph = scene.build()
    np.testing.assert_allclose(place_of(graph, graph.row("odd")), [1, 2.5, 0.6, np.pi / 2], atol=1e-6)


def test_the_error_is_that_of_the_best_draw_to_the_nearest_removed_thing():
    true = np.array([[0, 0, 0, 0], [2, 0, 0, np.radians(170)]])
    drawn = [np.array([5, 5, 0, 0]), np.array([2.03, 0.04, 0, np.radians(-170)])]
    centimetres, degrees = pose_error(drawn, true)
    assert centimetres == pytest.approx(5)
    assert degrees == pytest.approx(20)


def test_the_most_frequent_support_counts():
    assert most_common(["a", "b", "b"]) == "b"
    assert most_common(["a", "b"]) == "a"


def test_on_top_needs_contact_with_the_thing_that_was_asked_for():
    for height, good in ((0.75, True), (0.76, True), (0.80, False)):
        scene = Scene()
        table = scene.box("table", None, (0, 0, 0), category="Table", mesh=table_mesh())
        scene.box("cup", (0.08, 0.08, 0.1), (0.1, 0.1, height), category="Cup", parent=table)
        graph = scene.build()
        assert is_on(graph, graph.row("cup"), "table") is good
        assert not is_on(graph, graph.row("cup"), "floor")


@pytest.mark.parametrize(
    ("gap", "height", "good"), [(0.1, 0, True), (0.49, 0, True), (0.51, 0, False), (0.1, 1, False)]
)
def test_beside_is_half_a_metre_at_the_same_height(gap, height, good):
    scene = Scene()
    scene.box("a", (0.4, 0.4, 0.4), (0, 0, 0))
    scene.box("b", (0.4, 0.4, 0.4), (0.4 + gap, 0, height))
    graph = scene.build()
    assert is_beside(graph, graph.row("b"), "a") is good


def test_gaps_of_turned_footprints():
    square = np.array([0.5, 0.5, 0.5])
    assert footprint_gap(np.zeros(3), square, 0.0, np.array([[1.3, 0, 0, 0]]), square)[0] == pytest.approx(0.3)
    turned = np.array([1.3, 0, 0, np.pi / 4])
    assert footprint_gap(np.zeros(3), square, 0.0, turned[None], square)[0] == pytest.approx(0.8 - np.sqrt(0.5))
