"""Boards of objects, the spots on them, the order of placing, and what is told of a room."""

from __future__ import annotations

import numpy as np
import pytest

from tests.generate.rooms import at, box, room
from unisg_blender.dataset.assets.asset import object_graph
from unisg_blender.generate.observe.observed_scene import ObservedScene, within
from unisg_blender.generate.observe.placeable import Placeable
from unisg_blender.generate.observe.placement_order import DEEPEST, along, groups, learn_orders, levels
from unisg_blender.generate.observe.prior_tables import PriorTables
from unisg_blender.generate.observe.reference_objects import find_reference_objects
from unisg_blender.generate.observe.scene_tokens import tokens_for
from unisg_blender.generate.observe.support_candidates import (
    Proximity,
    SupportCandidates,
    SupportOccupancy,
    support_arrays,
)
from unisg_blender.generate.observe.support_priors import AT_SIDE, RESTS, CategoryPriors, SupportPrior, learn_priors
from unisg_blender.generate.place.free_space import FreeSpace
from unisg_blender.generate.place.settle_geometry import Support, nearest_support, rest
from unisg_blender.generate.place.support_planner import row_order
from unisg_blender.generate.propose.mixture import behind_walls
from unisg_blender.geometry.boxes import Boxes
from unisg_blender.scene import SceneBuilder, world_matrices
from unisg_blender.spatial.level_surfaces import LevelSurfaces, rectangles, with_joined
from unisg_blender.spatial.objects import SceneObjects, scene_objects
from unisg_blender.spatial.support_surfaces import support_surfaces, surface_at

VOCABULARY = ("Cup", "Floor", "Lamp", "Table", "Wall")


def scene_of(seed: int, cups: int = 3) -> ObservedScene:
    graph = room(seed, cups)
    objects = scene_objects(graph, VOCABULARY)
    return ObservedScene.of(objects, world_matrices(graph)[objects.row])


def shelf() -> Boxes:
    """Boards 1 x 0.4 m at 0.1, 0.5 and 0.9 m between two sides."""
    center = [(0, 0, 0.09), (0, 0, 0.49), (0, 0, 0.89), (-0.51, 0, 0.5), (0.51, 0, 0.5)]
    half = [(0.5, 0.2, 0.01)] * 3 + [(0.01, 0.2, 0.5)] * 2
    return Boxes(np.array(center), np.tile(np.eye(3), (5, 1, 1)), np.array(half), np.ones(5, bool))


def test_a_shelf_has_its_boards_with_headroom_and_no_edges() -> None:
    surfaces = support_surfaces(shelf(), bottom=0.0)
    np.testing.assert_allclose(surfaces[:, 0], [0.1, 0.5, 0.9])
    np.testing.assert_allclose(surfaces[:, 1], 0.4)
    np.testing.assert_allclose(surfaces[:, 2], [0.38, 0.38, 2.0])
    assert surface_at(surfaces, 0.51) == 1
    assert surface_at(surfaces, 0.3) == -1
    assert len(support_surfaces(shelf().take(np.zeros(0, int)), 0.0)) == 0


def test_spots_tell_what_lies_where() -> None:
    scene = scene_of(1)
    table = int(np.flatnonzero(scene.category == 3)[0])
    candidates = SupportCandidates.of(scene, [table])
    assert candidates.surface.tolist() == [0, -1]
    everything, near, half = np.ones(len(scene.category), bool), np.zeros((len(scene.category), 6)), np.full(3, 0.04)
    arrays = support_arrays(scene, candidates, SupportOccupancy.of(scene, everything), near, 0, half, 5)
    np.testing.assert_allclose(arrays["support_content"][0], np.log1p([3, 0, 0, 0, 0, 0]), atol=1e-6)
    assert not arrays["support_content"][1].any()
    nothing = support_arrays(scene, candidates, SupportOccupancy.of(scene, ~everything), near, 0, half, 5)
    assert not nothing["support_content"].any()


def test_what_stands_near_a_support_is_told_by_category() -> None:
    scene = scene_of(1)
    table, floor = (int(np.flatnonzero(scene.category == number)[0]) for number in (3, 1))
    everything = np.ones(len(scene.category), bool)
    nearness = Proximity.of(scene)
    found = nearness.by_kind(scene, everything, 5)
    walls = np.flatnonzero(scene.category == 4)
    assert set(nearness.obj.tolist()) == {table, *walls.tolist()}  # what stands on the floor
    assert found[floor, 3] == pytest.approx(1.0)  # the table's middle is over it
    assert found[table, 3] == 0  # not near itself
    assert 0 < found[table, 4] < 1
    cup = int(np.flatnonzero(scene.category == 0)[0])
    assert found[cup, 3] == pytest.approx(1.0)
    unseen = everything.copy()
    unseen[walls] = False
    assert not nearness.by_kind(scene, unseen, 5)[:, 4].any()


def test_a_table_top_of_pieces_is_one_surface_and_steps_are_not() -> None:
    def tops(places: list[tuple[float, float, float]]) -> LevelSurfaces:
        center = np.array(places)
        half = np.tile([0.25, 0.3, 0.02], (len(places), 1))
        return rectangles(Boxes(center, np.tile(np.eye(3), (len(places), 1, 1)), half, np.ones(len(places), bool)))

    table = with_joined(tops([(-0.5, 0, 0.7), (0.02, 0, 0.7), (0.54, 0, 0.7)]))
    assert len(table.top) == 4
    np.testing.assert_allclose(sorted(table.half[0]), [0.3, 0.77])
    np.testing.assert_allclose(table.center[0], [0.02, 0], atol=1e-9)
    assert len(with_joined(tops([(-0.5, 0, 0.7), (0.02, 0, 0.5)])).top) == 2  # on two levels
    assert len(with_joined(tops([(-2.0, 0, 0.7), (2.0, 0, 0.7)])).top) == 2  # far apart


def test_leaders_are_those_from_whom_others_can_be_told() -> None:
    rng, scenes = np.random.default_rng(0), []
    for _ in range(40):
        table, yaw = rng.uniform(-3, 3, 2), rng.uniform(-np.pi, np.pi)
        turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
        chairs = table + (turn @ np.array([[0.0, 0.0], [1.0, -1.0]])).T + rng.normal(0, 0.02, (2, 2))
        bin_place = rng.uniform(-3, 3, 2)
        center = np.column_stack([np.vstack([[0, 0], table, chairs, bin_place]), np.zeros(5)])
        turns = np.array([0.0, yaw, yaw, yaw, 0.0])
        kinds, support = np.array([0, 1, 2, 2, 3]), np.array([-1, 0, 0, 0, 0])
        none = Boxes(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 3)), np.zeros(0, bool))
        owner = np.zeros(0, np.int64)
        scenes.append(SceneObjects(np.arange(5), kinds, support, center, np.ones((5, 3)), turns, none, owner, ()))
    assert find_reference_objects(scenes, ("Floor", "Table", "Chair", "Bin")) == ["Table"]


def test_things_are_ordered_by_level_and_rows_from_end_to_end() -> None:
    scene = scene_of(2)
    graph = room(2, 3)
    priors = learn_priors([scene_objects(graph, VOCABULARY)], VOCABULARY)
    assert groups(VOCABULARY, priors).tolist() == [2, 0, 2, 1, 1, -1]
    cups = np.flatnonzero(scene.category == 0)
    assert (np.diff(along(scene)[cups]) > 0).all()  # they were laid from left to right
    orders = learn_orders([scene], VOCABULARY)
    assert orders.keys() == {"Table>Cup", "Wall>Lamp"}
    tables, cup, floor, table = PriorTables.of(priors, VOCABULARY), 0, 1, 3
    assert sorted(row_order([cup, cup], table, False, tables, np.random.default_rng(0))) == [0, 1]
    assert row_order([cup, table], floor, True, tables, np.random.default_rng(0)) == [1, 0]


def test_whatever_may_hold_a_thing_is_placed_before_it() -> None:
    def on(*names: str) -> list[SupportPrior]:
        return [SupportPrior(name, 9, RESTS) for name in names]

    supports = {
        "Floor": on(""), "Rug": on("Floor"), "Table": on("Floor", "Rug"), "Book": on("Shelf", "Table"),
        "Shelf": on("Floor"), "Crate": on("Floor", "Crate", "Box"), "Box": on("Crate"),
    }  # fmt: skip
    found = levels(CategoryPriors(supports, {}, {}, []))
    assert {name: found[name] for name in ("Floor", "Rug", "Table", "Shelf", "Book")} == {
        "Floor": 0, "Rug": 1, "Table": 2, "Shelf": 1, "Book": 3,
    }  # fmt: skip
    assert max(found.values()) == DEEPEST  # crates on boxes on crates


def wall(*placeables: tuple[float, float, float]) -> Support:
    """A wall along y of pieces (x, y of the middle, length), 0.2 m thick and 2 m high."""
    center = np.array([[x, y, 1.0] for x, y, _ in placeables])
    half = np.array([[0.1, length / 2, 1.0] for _, _, length in placeables])
    boxes = Boxes(center, np.tile(np.eye(3), (len(placeables), 1, 1)), half, np.ones(len(placeables), bool))
    return Support(0, SupportPrior("Wall", 9, AT_SIDE), boxes, False)


def cup_in_empty_space() -> tuple[Placeable, FreeSpace]:
    none = Boxes(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 3)), np.zeros(0, bool))
    space = FreeSpace(
        none,
        np.zeros(0, np.int64),
        np.zeros(0, np.int64),
        None,
        PriorTables.of(CategoryPriors({}, {}, {}, []), ("Wall",)),
    )
    return Placeable(object_graph(room(1, 1), room(1, 1).row("Cup.0"))), space


def test_of_two_walls_the_nearer_one_holds() -> None:
    placeable, space = cup_in_empty_space()
    places = np.array([[-1.7, 0.3, 1.0, 0.0], [1.5, -0.4, 1.0, 0.0]])
    assert nearest_support(placeable, places, [wall((-2, 0, 4)), wall((2, 0, 4))], space).tolist() == [0, 1]


def test_what_a_wall_holds_stays_where_it_is_along_all_its_pieces() -> None:
    placeable, space = cup_in_empty_space()
    opened = wall((0, -1.5, 1.0), (0, 1.0, 2.0))  # an opening from -1 to 0
    places = np.array([[0.5, y, 1.0, 0.0] for y in (-1.6, 0.7, -5.0, 5.0)])
    found = rest(placeable, places, opened, space)
    np.testing.assert_allclose(found[:, 0], 0.1 + placeable.half[0], atol=1e-9)
    np.testing.assert_allclose(found[:, 1], [-1.6, 0.7, -2 + placeable.half[1], 2 - placeable.half[1]], atol=1e-9)


def test_tokens_begin_with_the_support_and_its_things() -> None:
    scene = scene_of(3)
    table, cups = int(np.flatnonzero(scene.category == 3)[0]), np.flatnonzero(scene.category == 0)
    seen = np.ones(len(scene.category), bool)
    tokens = tokens_for(scene, seen, table, 0, 0.8, np.full(3, 0.04))
    assert tokens[0] == table
    assert set(cups) <= set(tokens.tolist())
    assert scene.support[table] in tokens
    seen[cups] = False
    assert not set(cups) & set(tokens_for(scene, seen, table, 0, 0.8, np.full(3, 0.04)).tolist())


def test_walls_know_on_which_side_the_room_is() -> None:
    scene = scene_of(4)
    found = scene.room
    walls = scene.category == 4
    assert (np.abs(found.inner[walls]) == 1).all()
    assert not found.inner[~walls].any()
    assert scene.room is found


def test_places_behind_a_wall_are_told_from_places_in_the_room() -> None:
    wall = np.array([[0, 2, 1.25, 3, 0.05, 1.25, 1, 0]], np.float32)  # along x at y = 2, the room below it
    flags = np.zeros((1, 7), np.float32)
    flags[0, 4] = -1
    places = np.array([[0, 1.5], [0, 1.84], [0, 1.99], [0, 2.5], [4, 2.5], [0, 9.0]])
    assert behind_walls(wall, flags, places, 0.1).tolist() == [False, False, True, True, False, False]
    flags[0, 0] = 1  # the wall holds it: a door
    assert not behind_walls(wall, flags, places, 0.1).any()


def test_matrices_relative_to_others_agree_with_the_inverse() -> None:
    rng = np.random.default_rng(0)
    above, world = np.tile(np.eye(4), (2, 20, 1, 1))
    above[:, :3], world[:, :3] = rng.normal(size=(2, 20, 3, 4))
    np.testing.assert_allclose(within(above, world), np.linalg.solve(above, world), rtol=1e-9, atol=1e-9)
    above[0, :3, :3] = 0  # scaled to nothing
    flat = within(above, world)[0]
    np.testing.assert_allclose(flat[:3, 3], world[0, :3, 3] - above[0, :3, 3])
    np.testing.assert_array_equal(flat[:3, :3], world[0, :3, :3])


def test_two_boards_of_a_scene_are_told_apart() -> None:
    builder = SceneBuilder("Boards")
    floor = builder.add("Floor", uid="f", local=at(0, 0, -0.1), mesh=box("Floor", 4, 4, 0.1), category="Floor")
    table = builder.add("T", uid="t", parent=floor, local=at(0, 0, 0.1), mesh=box("T", 1, 1, 0.5), category="Table")
    builder.add("C", uid="c", parent=table, local=at(0, 0, 0.5), mesh=box("C", 0.1, 0.1, 0.1), category="Cup")
    builder.add("D", uid="d", parent=table, local=at(0.8, 0, 0.2), mesh=box("C", 0.1, 0.1, 0.1), category="Cup")
    graph = builder.build()
    objects = scene_objects(graph, VOCABULARY)
    scene = ObservedScene.of(objects, world_matrices(graph)[objects.row])
    assert scene.surface[scene.category == 0].tolist() == [0, -1]
