"""The last check: what is outside, in the air, in something or before a door is told and taken out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.spatial.built_rooms import SQUARE, Hole, box, joined, room, scene
from unisg_blender.generate import Generator
from unisg_blender.generate.check.holding_scene import only_what_holds
from unisg_blender.generate.check.mesh_check import faults
from unisg_blender.generate.place.placement_record import Placement
from unisg_blender.geometry.triangle_crossings import crossings, edges_of
from unisg_blender.pretrained import find_generator

ROOM = room(SQUARE, 0.2, roof=True, holes=(Hole(0, 1.0, 2.0),), one="all")
BEFORE = scene(ROOM | {"desk": box((3, 2, 0), (4, 3, 0.7))})


def fault(low, high) -> str:
    """What is said of a box in the room."""
    return faults(scene(ROOM | {"desk": box((3, 2, 0), (4, 3, 0.7)), "new": box(low, high)}), BEFORE, ["new"]).get(
        "new", ""
    )


@pytest.mark.parametrize(
    ("low", "high", "reason"),
    [
        ((1, 2, 0), (1.5, 2.5, 0.5), ""),
        ((3.2, 2.2, 0.7), (3.4, 2.4, 0.9), ""),
        ((3.2, 2.2, 0.697), (3.4, 2.4, 0.9), ""),
        ((2.5, 2, 0), (3.003, 2.5, 0.5), ""),
        ((2.5, 2, 0), (3.02, 2.5, 0.5), "in desk"),
        ((3.3, 2.3, 0.2), (3.6, 2.6, 0.5), "in the air"),
        ((4.8, 2, 0), (5.1, 2.5, 0.5), "in house"),
        ((1, 2, 0.2), (1.5, 2.5, 0.5), "in the air"),
        ((8, 2, 0), (8.5, 2.5, 0.5), "outside"),
        ((1.2, 0.1, 0), (1.7, 0.5, 0.5), "door"),
    ],
)
def test_faults_of_a_box(low, high, reason) -> None:
    said = fault(low, high)
    assert reason in said
    assert bool(said) == bool(reason)


@pytest.mark.parametrize(("height", "reason"), [(2.2, "it would be in crate"), (3.0, "")])
def test_what_stands_within_something_closed_is_in_it_however_far_its_faces_are(height: float, reason: str) -> None:
    """Unless it is as large as a house: a room is around all that is in it."""
    parts = {"crate": box((1, 0.8, 0), (3.8, 3.4, height)), "board": box((2.2, 1.8, 0.5), (2.8, 2.4, 0.52))}
    before = scene(ROOM | parts)
    after = scene(ROOM | parts | {"new": box((2.3, 1.9, 0.52), (2.5, 2.1, 0.7))})
    assert faults(after, before, ["new"]).get("new", "") == reason


def test_of_two_in_each_other_the_later_goes_and_what_stands_on_it() -> None:
    boxes = {
        "one": box((1, 2, 0), (1.5, 2.5, 0.5)), "two": box((1.3, 2, 0), (1.8, 2.5, 0.4)),
        "three": box((2, 1, 0), (2.3, 1.3, 0.3)),
    }  # fmt: skip
    after = scene(ROOM | {"desk": box((3, 2, 0), (4, 3, 0.7))} | boxes)
    made = [Placement("Crate", name, name, "floor", np.eye(4)) for name in boxes]
    kept, told = only_what_holds(BEFORE, after, made)
    assert [item.refused for item in told] == [False, True, False]
    assert told[1].note == "it would be in one"
    assert set(kept.name) == set(after.name) - {"two"}


@given(st.lists(st.floats(-1, 1), min_size=15, max_size=15))
@settings(max_examples=60, deadline=None)
def test_a_segment_goes_through_where_its_meeting_point_lies_in_the_triangle(numbers) -> None:
    values = np.array(numbers).reshape(5, 3)
    triangle, segment = values[:3], values[3:]
    system = np.column_stack([triangle[1] - triangle[0], triangle[2] - triangle[0], segment[0] - segment[1]])
    if abs(np.linalg.det(system)) < 1e-3:
        return
    u, v, t = np.linalg.solve(system, segment[0] - triangle[0])
    margin = min(u, v, 1 - u - v, t, 1 - t)
    if abs(margin) > 1e-6:
        assert bool(len(crossings(segment[None], triangle[None])[0])) == (margin > 0)


def test_edges_of_triangles() -> None:
    triangles = np.arange(18.0).reshape(2, 3, 3)
    assert edges_of(triangles).shape == (6, 2, 3)
    assert np.array_equal(edges_of(triangles)[5], triangles[1, [2, 0]])


def test_what_is_reported_as_placed_holds() -> None:
    generator = Generator.load(find_generator("living_room"))
    house = scene({"house": joined([ROOM["house"], box((3, 2, 0), (4, 3, 0.7))])})
    for seed in range(3):
        made = generator.add(house, {"Chair": 3, "Plant": 2, "Bookshelf": 2}, seed, behaviour=False)
        assert made.added >= 5
        assert not faults(made.scene, house, [item.uid for item in made.objects if item.uid])
        assert {made.scene.name[row] for row in made.rows} >= {item.name for item in made.objects if item.name}


@pytest.mark.parametrize(("size", "holds"), [(0.8, True), (4.0, False)])
def test_there_is_ground_beside_furniture_but_neither_beside_a_building_nor_on_its_roof(size, holds) -> None:
    before = {"thing": box((0, 0, 0), (size, size, size))}
    beside, above = box((9, 9, 0), (9.5, 9.5, 0.5)), box((0.2, 0.2, size), (0.5, 0.5, size + 0.4))
    after = scene(before | {"beside": beside, "above": above})
    assert set(faults(after, scene(before), ["beside", "above"])) == (set() if holds else {"beside", "above"})
