"""What is placed leaves a way through the room, and to its doors."""

from __future__ import annotations

import numpy as np
import pytest

from tests.spatial.built_rooms import CORRIDOR, SQUARE, Hole, box, room, scene
from unisg_blender.generate.check.mesh_check import CUTTING, faults


def told(outline, things, holes=()) -> dict[str, str]:
    """What is said of new boxes in a room."""
    before = room(outline, 0.1, holes=holes)
    return faults(scene(before | things), scene(before), list(things))


@pytest.mark.parametrize(("width", "holds"), [(0.45, True), (0.8, False)])
def test_a_corridor_stays_a_corridor(width: float, holds: bool) -> None:
    """Of 1.2 m a person needs more than half a metre."""
    said = told(CORRIDOR, {"cabinet": box((4, 0, 0), (5, width, 1.5))})
    assert said == ({} if holds else {"cabinet": CUTTING})


def test_a_rug_and_what_hangs_high_are_no_obstacles() -> None:
    assert not told(CORRIDOR, {"rug": box((3, 0.1, 0), (5, 1.1, 0.02))})


def test_of_two_that_cut_together_the_later_goes() -> None:
    pair = {"one": box((2, 0, 0), (2.4, 1.7, 1)), "two": box((2, 2.0, 0), (2.4, 4, 1))}
    assert told(SQUARE, pair) == {"two": CUTTING}
    swapped = {name: pair[name] for name in ("two", "one")}
    assert told(SQUARE, swapped) == {"one": CUTTING}


def test_a_small_nook_may_be_cut_off_but_no_door() -> None:
    """A wardrobe and a shelf around a corner of 0.7 m2: nobody wants to go there, unless a door is in it."""
    around = {"wardrobe": box((0.9, 0, 0), (1.4, 1.4, 1.9)), "shelf": box((0, 0.95, 0), (0.88, 1.4, 1.9))}
    assert not told(SQUARE, around)
    with_door = told(SQUARE, around, holes=(Hole(0, 0.05, 0.85),))
    assert set(with_door) <= {"wardrobe", "shelf"}
    assert CUTTING in with_door.values()
    assert np.ptp(SQUARE[:, 0]) == 5
