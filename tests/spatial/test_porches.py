"""Porches before halls: what is open to the land around, beyond a doorway without a lintel, is no part of a room."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.spatial.structure import recognise_structure

from .built_rooms import SQUARE, Hole, joined, overlap, room, scene, slab, walls

HALL = np.array([[0, 0], [12, 0], [12, 9], [0, 9]], float)
ANGLED = np.array([[0, 0], [12, 0], [12, 3], [1.8, 3], [1.8, 9], [0, 9]], float)
LAND = {"ground": slab(np.array([[-20, -20], [32, -20], [32, 29], [-20, 29]], float), -0.2, 0.0)}
SQUARE_DOORWAY, DOORWAY = Hole(2, 1.6, 3.4, 0.0, 3.0), Hole(2, 5.1, 6.9, 0.0, 3.0)
"""Openings of 1.8 m up to the top of the far wall."""


def before(outline, depth):
    """A place of four metres in width before the middle of the far wall of a rectangle, which is 0.2 m thick."""
    middle, wall = outline[:, 0].max() / 2, outline[:, 1].max() + 0.2
    return np.array([[middle - 2, wall], [middle + 2, wall], [middle + 2, wall + depth], [middle - 2, wall + depth]])


def open_hall(outline=HALL, doorways=(DOORWAY,)):
    """A hall without a roof on wide land."""
    return room(outline, 0.2, 3.0, holes=doorways) | LAND


def beside(outline, depth, sides):
    """Walls at some sides of the place before the far wall; 2 is the one that ends it."""
    around = walls(before(outline, depth), 0.0, 3.0, 0.2)
    return {f"wing {side}": around[side] for side in sides}


def found(parts):
    """The shape of the only room indoors."""
    (only,) = (some for some in recognise_structure(scene(parts)).rooms if some.indoors)
    return only.outline, *only.holes


@pytest.mark.parametrize("depth", [2.5, 3.0, 4.0])
def test_a_porch_without_a_roof_is_outside(depth) -> None:
    shape = found(open_hall() | beside(HALL, depth, (1, 3)))
    assert overlap(shape, (HALL,), 0.05) >= 0.995
    assert shape[0][:, 1].max() <= 9.2


def test_a_small_room_before_a_porch_is_a_room() -> None:
    assert overlap(found(open_hall(SQUARE, (SQUARE_DOORWAY,)) | beside(SQUARE, 2.0, (1, 3))), (SQUARE,)) >= 0.99


@pytest.mark.parametrize("size", [(7, 6), (8, 6)])
def test_a_room_with_a_gate_stays_a_room(size) -> None:
    """An opening of 2.4 m is no neck, and what is wide there is more land than room: but its rim is hardly open."""
    outline = np.array([[0, 0], [size[0], 0], size, [0, size[1]]], float)
    gate = Hole(2, size[0] / 2 - 1.2, size[0] / 2 + 1.2, 0.0, 3.0)
    assert overlap(found(open_hall(outline, (gate,))), (outline,), 0.05) >= 0.96


def test_an_alcove_is_part_of_the_room() -> None:
    """The same walls with one more across: nothing beyond the doorway is open."""
    alcove = before(HALL, 3.0)
    whole = np.array([*HALL[:3], (6.9, 9), (6.9, 9.2), *alcove[1:], alcove[0], (5.1, 9.2), (5.1, 9), HALL[3]])
    assert overlap(found(open_hall() | beside(HALL, 3.0, (1, 2, 3))), (whole,), 0.05) >= 0.995


@pytest.mark.parametrize("depth", [2.0, 3.0])
def test_a_bay_under_the_same_roof_is_part_of_the_room(depth) -> None:
    """The porch with a roof that goes on over it; its front is open, and where it ends there is told by sight only."""
    bay = before(HALL, depth)
    roofs = [slab(HALL, 3.0, 3.1), slab(bay - np.array([0.0, 0.2]), 3.0, 3.1)]
    whole = np.array([*HALL[:3], (6.9, 9), (6.9, 9.2), *bay[1:], bay[0], (5.1, 9.2), (5.1, 9), HALL[3]])
    shape = found(open_hall() | beside(HALL, depth, (1, 3)) | {"roof": joined(roofs)})
    assert overlap(shape, (whole,), 0.05) >= 0.975


def test_an_arm_as_narrow_as_a_doorway_is_part_of_the_room() -> None:
    assert overlap(found(room(ANGLED, 0.2, 3.0) | LAND), (ANGLED,), 0.05) >= 0.995


def test_a_half_wall_parts_nothing() -> None:
    """Between its end and the far wall it leaves a way of 1.8 m."""
    half = slab(np.array([[6, 0], [6.2, 0], [6.2, 7.2], [6, 7.2]]), 0.0, 3.0)
    whole = np.array([HALL[0], (6, 0), (6, 7.2), (6.2, 7.2), (6.2, 0), *HALL[1:]])
    door = Hole(1, 3.0, 3.9)
    assert overlap(found(open_hall(doorways=(door,)) | {"half": half}), (whole,), 0.05) >= 0.995
