"""Pointing into a room: the map of places, the best one near a point, what is wrong there, what is placed."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generate.house import house
from tests.spatial.built_rooms import box, mesh
from unisg_blender.dataset.assets.asset import object_graph
from unisg_blender.errors import UniSGError
from unisg_blender.generate import Generator
from unisg_blender.generate.check.mesh_check import faults
from unisg_blender.generate.check.scene_check import check_scene
from unisg_blender.generate.pointing.ghosts import ghost_anywhere, ghost_at, ghost_by_hand, ghost_near, measured
from unisg_blender.generate.pointing.nearby_places import APART, TURNED, best_near, distances
from unisg_blender.generate.pointing.placed_object import place_ghost
from unisg_blender.generate.pointing.placing_room import PlacingRoom, Wanted
from unisg_blender.geometry.planar import wrapped
from unisg_blender.pretrained import shipped_generators
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.worlds import living_room


@cache
def generator() -> Generator:
    return Generator.load(next(path for path in shipped_generators() if path.stem == "living_room"))


@cache
def scene() -> SceneGraph:
    return living_room(5)


@cache
def room(category: str, on: str = "", beside: str = "") -> PlacingRoom:
    return PlacingRoom.of(generator(), scene(), Wanted(category, on=on, beside=beside))


def row_of(category: str) -> int:
    return next(row for row in range(len(scene())) if scene().category_name(row) == category)


def test_the_map_covers_the_floor_boards_and_walls_that_may_hold_it() -> None:
    holder = {name: room(name).scene.labels for name in ("Chair", "Cup", "Picture")}
    found = {name: {holder[name][obj].name.split(".")[0] for obj in set(room(name).map.support)} for name in holder}
    assert found == {"Chair": {"Floor"}, "Cup": {"Dining Table", "Coffee Table"}, "Picture": {"Wall"}}
    chair = room("Chair").map
    assert chair.cells.area.sum() == pytest.approx(sum(chair.cells.area[chair.cells.area > 1e-6]))
    outline = room("Chair").scene.space.outline
    assert outline is not None
    low, high = outline.min(axis=0), outline.max(axis=0)
    assert chair.cells.area.sum() > 0.8 * np.prod(high - low)
    assert np.exp(chair.log_density) @ chair.cells.area == pytest.approx(1.0, abs=0.01)
    assert chair.heat.max() == 1.0
    assert (chair.heat[~chair.fits] == 0).all()


@settings(max_examples=15)
@given(st.integers(0, 10**6), st.sampled_from(["Chair", "Cup", "Picture", "Cushion"]))
def test_the_ghost_is_near_the_point_free_and_right_by_the_last_check(seed: int, category: str) -> None:
    asked, rng = room(category), np.random.default_rng(seed)
    point = asked.map.aim[rng.integers(len(asked.map))] + rng.normal(0, 0.1, 3)
    ghost = ghost_near(asked, point)
    if ghost is None:
        assert not (asked.map.fits & (distances(asked.map, point) < 0.8)).any()
        return
    made = place_ghost(asked, ghost, seed=1, behaviour=False)
    uid = made.objects[0].uid
    assert (uid in faults(made.scene, scene(), [uid])) <= bool(ghost.wrong)
    assert np.linalg.norm(ghost.place[:2] - point[:2]) < 1.5


def test_the_wheel_goes_through_places_that_are_apart() -> None:
    asked = room("Chair")
    point = asked.map.aim[int(np.flatnonzero(asked.map.fits)[0])]
    numbers = best_near(asked.map, distances(asked.map, point))
    assert len(numbers) > 3
    places = asked.map.places[numbers]
    for one in range(len(places)):
        for other in range(one):
            apart = np.linalg.norm(places[one, :3] - places[other, :3])
            assert apart >= APART or abs(wrapped(places[one, 3] - places[other, 3])) >= TURNED
    seen = {tuple(ghost_near(asked, point, number).place) for number in range(1, len(numbers))}  # type: ignore[union-attr]
    assert len(seen) == len(numbers) - 1
    again = ghost_near(asked, point, len(numbers) + 1)
    assert again is not None
    assert tuple(again.place) in seen


def test_by_hand_it_stands_at_the_point_and_what_is_wrong_is_said() -> None:
    asked, sofa = room("Chair"), scene().world[row_of("Sofa")][:3, 3]
    ghost = ghost_by_hand(asked, np.array([*sofa[:2], 0.0]), 0.5)
    np.testing.assert_allclose(ghost.place[:2], sofa[:2])
    assert ghost.wrong
    assert ghost.wrong[0].startswith("collides with ")
    told = measured(asked, ghost)
    assert told.wrong[0].endswith(("cm", "m"))
    high = ghost_at(asked, np.array([0.0, 0.0, 2.0, 0.0]))
    assert high.wrong == ("floats",)
    assert measured(asked, high).wrong[0].startswith("floats by ")
    assert ghost_at(asked, np.array([30.0, 0.0, 0.0, 0.0])).wrong == ("is outside the building",)


def test_what_is_wrong_is_what_the_check_says_of_it_when_it_is_there() -> None:
    asked, table = room("Chair"), scene().world[row_of("Coffee Table")][:3, 3]
    ghost = ghost_by_hand(asked, np.array([table[0] + 0.2, table[1], 0.0]), 0.0)
    made = place_ghost(asked, ghost, seed=1, behaviour=False)
    new = made.scene.row_of_uid[made.objects[0].uid]
    pairs = [{made.scene.name[fault.row], made.scene.name[fault.other]} for fault in check_scene(made.scene).faults]
    other = measured(asked, ghost).wrong[0].removeprefix("collides with ").split(" by ")[0]
    assert {other, made.scene.name[new]} in pairs


def test_wishes_are_kept_by_what_is_proposed_and_told_of_what_is_not() -> None:
    table = scene().name[row_of("Coffee Table")]
    on = room("Cup", on=table)
    assert {on.scene.labels[obj].name for obj in set(on.map.support)} == {table}
    assert f"is not on {table}" in ghost_at(on, np.array([0.0, 0.0, 0.0, 0.0])).wrong
    sofa = scene().name[row_of("Sofa")]
    beside = room("Chair", beside=sofa)
    ghost = ghost_anywhere(beside, np.random.default_rng(0))
    assert ghost is None or not any("beside" in line for line in ghost.wrong)
    far = beside.scene.observed.center[beside.beside] + (4.0, 4.0, 0.0)
    assert f"is not beside {sofa}" in ghost_at(beside, np.append(far, 0.0)).wrong


def test_what_is_placed_is_one_object_more_with_its_actions_and_nothing_else_moves() -> None:
    asked = room("Cup")
    ghost = ghost_anywhere(asked, np.random.default_rng(2))
    assert ghost is not None
    made = place_ghost(asked, ghost, seed=4)
    assert made.added == 1
    assert made.scene.category_name(made.scene.row_of_uid[made.objects[0].uid]) == "Cup"
    np.testing.assert_allclose(made.scene.world[made.scene.row_of_uid[made.objects[0].uid]], ghost.world, atol=1e-9)
    assert made.objects[0].support.startswith(("Dining Table", "Coffee Table"))
    for row, uid in enumerate(scene().uid):
        np.testing.assert_array_equal(made.scene.world[made.scene.row_of_uid[uid]], scene().world[row])
    again = place_ghost(asked, ghost, seed=4)
    assert again.scene.uid == made.scene.uid


def test_other_shapes_follow_each_other_and_a_given_one_is_taken() -> None:
    rooms = [PlacingRoom.of(generator(), scene(), Wanted("Sofa", shape)) for shape in (0, 1)]
    keys = [each.target.placeable.asset.key for each in rooms]
    assert keys[0] != keys[1]
    assert [each.shapes for each in rooms] == [3, 3]
    assert room("Chair").shapes == 1
    own = object_graph(scene(), row_of("Sofa"))
    given = PlacingRoom.of(generator(), scene(), Wanted("Armchair", asset=own))
    assert given.target.placeable.asset.key == own.key
    assert given.wanted.category == "Armchair"


def test_words_that_the_model_does_not_know_are_placed_by_rules() -> None:
    asked = PlacingRoom.of(generator(), scene(), Wanted("fridge"))
    assert asked.wanted.category == "Refrigerator"
    ghost = ghost_anywhere(asked, np.random.default_rng(0))
    assert ghost is not None
    assert not ghost.wrong
    with pytest.raises(UniSGError, match="does not know"):
        PlacingRoom.of(generator(), scene(), Wanted("Qwertz"))
    with pytest.raises(UniSGError, match="give a category"):
        PlacingRoom.of(generator(), scene(), Wanted(""))


def test_of_a_house_it_is_the_room_in_which_one_points() -> None:
    kitchen = PlacingRoom.of(generator(), house(), Wanted("Chair"), near=np.array([2.0, 1.0, 0.0]))
    assert kitchen.map.fits.any()
    assert (kitchen.map.aim[kitchen.map.fits][:, 0] < 5.1).all()
    assert kitchen.has(np.array([1.0, 1.0, 0.1]))
    assert not kitchen.has(np.array([8.0, 1.0, 0.1]))
    bedroom = PlacingRoom.of(generator(), kitchen.graph, kitchen.wanted, np.array([7.0, 1.0, 0.0]), before=kitchen)
    assert bedroom.check is kitchen.check
    assert bedroom.scene is not kitchen.scene
    cup = PlacingRoom.of(generator(), kitchen.graph, Wanted("Cup"), np.array([2.0, 1.0, 0.0]), before=kitchen)
    assert cup.scene is kitchen.scene
    assert (bedroom.map.aim[bedroom.map.fits][:, 0] > 5.0).all()


def test_without_a_room_it_stands_on_the_ground() -> None:
    asked = PlacingRoom.of(generator(), SceneBuilder("Empty").build(), Wanted("Chair"))
    ghost = ghost_at(asked, np.array([1.0, 1.0, 0.0, 0.0]))
    made = place_ghost(asked, ghost, seed=0)
    assert (made.added, ghost.wrong) == (1, ())
    np.testing.assert_allclose(asked.target.placeable.motion(ghost.place)[:2, 3], (1, 1), atol=0.5)


def test_what_cuts_the_way_through_a_room_is_told_when_one_rests() -> None:
    shelf = mesh(box((-2.45, -0.2, 0), (2.45, 0.2, 2.2)))
    builder = SceneBuilder("Shelf")
    builder.add("Shelf", uid="Shelf", mesh=shelf, category="Bookshelf")
    asked = PlacingRoom.of(
        generator(), house(things={}), Wanted("Bookshelf", asset=object_graph(builder.build(), 0)),
        near=np.array([2.5, 2.0, 0.0]),
    )  # fmt: skip
    ghost = ghost_at(asked, np.array([2.5, 2.0, 0.0, 0.0]))
    assert ghost.wrong == ()
    assert measured(asked, ghost).wrong == ("blocks the way through the room",)


def test_what_stands_before_a_door_is_told_at_once() -> None:
    crate = SceneBuilder("Crate")
    crate.add("Crate", uid="Crate", mesh=mesh(box((-0.15, -0.2, 0), (0.15, 0.2, 0.5))), category="Side Table")
    given = Wanted("Side Table", asset=object_graph(crate.build(), 0))
    asked = PlacingRoom.of(generator(), house(), given, near=np.array([2.5, 2.0, 0.0]))
    assert ghost_at(asked, np.array([4.8, 0.85, 0.0, 0.0])).wrong == ("blocks a door",)
    assert ghost_at(asked, np.array([2.5, 1.5, 0.0, 0.0])).wrong == ()
