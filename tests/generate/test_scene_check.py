"""Each thing of a scene is told to be fine, or what is wrong with it and by how much."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generate.house import BEDROOM, KITCHEN, house
from tests.spatial.built_rooms import box, mesh, table
from unisg_blender.generate.check.scene_check import check_scene
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.worlds import living_room

PLAIN = KITCHEN | BEDROOM


def wrong(graph: SceneGraph) -> dict[str, str]:
    return {graph.name[fault.row]: fault.text for fault in check_scene(graph).faults}


def test_a_tidy_house_is_fine() -> None:
    check = check_scene(house())
    assert (check.checked, check.faults, check.summary) == (6, (), "6 things: 6 fine")


@pytest.mark.parametrize(
    ("thing", "said"),
    [
        (box((2, 1, 0.05), (2.5, 1.5, 0.5)), "floats by 5 cm"),
        (box((2, 1, 1.5), (2.5, 1.5, 2.0)), "floats by 1.5 m"),
        (box((0.2, 2.7, 0), (0.7, 3.23, 0.5)), "collides with Fridge.001 by 3 cm"),
        (box((0.2, 3.3, 1.87), (0.7, 3.8, 2.2)), "collides with Fridge.001 by 3 cm"),
        (box((4.6, 0.6, 0), (4.95, 1.1, 0.5)), "blocks a door"),
        (box((2, 7, 0), (2.5, 7.5, 0.5)), "is outside the building"),
    ],
)
def test_what_is_wrong_is_measured(thing, said: str) -> None:
    assert wrong(house(things=PLAIN | {"Crate": thing})) == {"Crate": said}


@settings(max_examples=12, deadline=None)
@given(st.integers(3, 60))
def test_the_gap_is_that_below(centimetres: int) -> None:
    low = centimetres / 100
    graph = house(things={"Crate": box((2, 1, low), (2.5, 1.5, low + 0.4))})
    assert wrong(graph) == {"Crate": f"floats by {centimetres} cm"}


@settings(max_examples=12, deadline=None)
@given(st.integers(2, 25))
def test_the_depth_is_that_of_the_overlap(centimetres: int) -> None:
    graph = house(things=KITCHEN | {"Crate": box((0.2, 2.6, 0), (0.7, 3.2 + centimetres / 100, 0.6))})
    assert wrong(graph) == {"Crate": f"collides with Fridge.001 by {centimetres} cm"}


def test_the_smaller_of_two_is_told_and_a_deep_one_so() -> None:
    graph = house(things=KITCHEN | {"Wardrobe": box((0.05, 2.2, 0), (2.2, 3.8, 2.2))})
    found = {graph.name[fault.row]: fault.text for fault in check_scene(graph).faults if fault.state == "collides"}
    assert set(found) <= {"Fridge.001", "SM_Stove_01", "Spüle"}
    assert "by more than 30 cm" in "".join(found.values())


def test_what_cuts_a_room_in_two_is_in_the_way() -> None:
    graph = house(things={"Shelf": box((0.02, 2.0, 0), (4.98, 2.4, 2.2))})
    assert wrong(graph) == {"Shelf": "blocks the way through the room"}


def test_what_hangs_or_is_mounted_is_fine() -> None:
    picture = box((2, 3.985, 1.3), (2.8, 4.01, 1.8))
    assert wrong(house(things=KITCHEN | {"Picture": picture})) == {}
    assert wrong(house(things={"table": table(2, 2, 0), "Cup": box((2, 2, 0.75), (2.08, 2.08, 0.85))})) == {}


def test_a_group_is_judged_as_one_thing() -> None:
    graph = house(things={})
    builder = SceneBuilder("Chair")
    top = builder.add("Chair_01", uid="Chair_01")
    for name, part in {"a": box((2, 2, 0.4), (2.4, 2.4, 0.45)), "b": box((2.1, 2.1, 0), (2.2, 2.2, 0.4))}.items():
        builder.add(name, uid=name, mesh=mesh(part), parent=top)
    for row in range(len(graph)):
        builder.add(graph.name[row], uid=graph.uid[row], mesh=graph.meshes[graph.mesh[row]])
    assert check_scene(builder.build()).summary == "1 thing: 1 fine"


def test_a_scene_without_anything_is_checked() -> None:
    assert check_scene(SceneBuilder("Empty").build()).summary == "0 things: 0 fine"


def test_our_own_rooms_are_fine() -> None:
    assert check_scene(living_room(3)).faults == ()
