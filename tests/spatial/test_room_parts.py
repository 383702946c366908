"""Recognised rooms as objects: a floor under the whole outline, wherever the room lies."""

from __future__ import annotations

import numpy as np

from unisg_blender.spatial.structure.room_objects import SLAB, _parts_of_room
from unisg_blender.spatial.structure.structure import Room

OUTLINE = np.array([[5, 2], [9, 2], [9, 5], [7, 5], [7, 8], [5, 8]], float)


def test_the_floor_is_under_the_outline() -> None:
    made = _parts_of_room(Room(OUTLINE, (), 1.5, 4.0, 0, True, 3, -1), set())
    np.testing.assert_allclose(made.center[0], [7, 5, 1.5 - SLAB / 2])
    np.testing.assert_allclose(made.half[0], [2, 3, SLAB / 2])
