"""What stands in a room leaves ways; what is new leaves them a little wider than just passable."""

from __future__ import annotations

import numpy as np
import pytest

from tests.spatial.built_rooms import SQUARE, box, room, scene
from unisg_blender.generate.check.ways_through import in_the_way
from unisg_blender.spatial.structure import recognise_structure
from unisg_blender.spatial.structure.scan import world_triangles


def shelf(gap: float) -> np.ndarray:
    """The triangles of a shelf across a room of 5 x 4 m, which ends so many metres before a wall."""
    return world_triangles(scene({"Shelf": box((0.0, 1.8, 0.0), (5.0 - gap, 2.2, 2.0))}))[0]


@pytest.mark.parametrize(
    ("gap", "passable", "spacious"), [(0.45, False, False), (0.62, True, False), (0.8, True, True)]
)
def test_a_way_is_passable_and_what_is_new_spares_more(gap: float, passable: bool, spacious: bool) -> None:
    graph = scene(room(SQUARE, 0.1))
    (found,) = recognise_structure(graph).rooms
    there = world_triangles(graph)[0]
    assert (in_the_way(found, there, [shelf(gap)]) == []) == passable
    assert (in_the_way(found, there, [shelf(gap)], 0.05) == []) == spacious


def test_a_way_that_was_narrow_before_is_judged_as_such() -> None:
    graph = scene(room(SQUARE, 0.1))
    (found,) = recognise_structure(graph).rooms
    there = np.concatenate([world_triangles(graph)[0], shelf(0.62)])
    small = world_triangles(scene({"Stool": box((2.0, 0.5, 0.0), (2.4, 0.9, 0.5))}))[0]
    assert in_the_way(found, there, [small], 0.05) == []
    plug = world_triangles(scene({"Crate": box((4.45, 1.9, 0.0), (4.95, 2.1, 0.5))}))[0]
    assert in_the_way(found, there, [plug], 0.05) == [0]
