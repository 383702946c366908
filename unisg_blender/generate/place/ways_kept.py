"""Do new things leave the floor of a room in one piece, so that people get everywhere on it?"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...spatial.free_floor import HEAD, STEP, FreeFloor
from ...spatial.structure.room_objects import RoomObjects
from ..observe.placeable import Placeable

WIDE = 0.26
"""Metres across of whoever walks: somewhat wider than those that judges of scenes let walk."""

REACHABLE = 0.98
"""Share of the free floor that stays in one piece; where it was less before, as much as that."""

CUTS, ROUND, CLEAR = 0, 1, 2
"""A thing cuts the floor; does not, if people walk over rugs; does not anyway."""


class WaysKept:
    """The free floor of a room while things are added: where rugs are walked over, and where they are in the way.

    In a room whose structure had to be recognised nothing is asked: there the last check follows the meshes.
    """

    def __init__(self, room: RoomObjects, movable: Bools) -> None:
        """``movable`` (K,) are the objects of the room that are no building."""
        self.ground, self.wanted = 0.0, True
        self.floors: list[FreeFloor] = []
        self._asked: dict[tuple[Any, ...], FreeFloor] = {}  # what a thing would leave, until one is put
        if room.outline is None or room.structure is not None or not room.floor.any():
            return
        objects = room.objects
        self.ground = float((objects.center + objects.half)[room.floor, 2].max())
        self.floors = [FreeFloor.of(room.outline, WIDE)] * 2
        for obj in np.intersect1d(objects.owner, np.flatnonzero(movable & ~room.floor)).tolist():
            place = np.array([*objects.center[obj, :2], objects.bottom[obj], objects.yaw[obj]])
            self._put(objects.half[obj], place)

    def add(self, placeable: Placeable, place: Floats) -> None:
        """Put a thing at a place (4,)."""
        self._put(placeable.half, place)

    def _put(self, half: Floats, place: Floats) -> None:
        self.floors = self._with(half, place)
        self._asked.clear()

    def _with(self, half: Floats, place: Floats) -> list[FreeFloor]:
        """The floors with a thing on those on which it is in the way."""
        taken = self._is_in_the_way(half, place)
        return [
            self._without(floor, half, place) if each else floor
            for floor, each in zip(self.floors, taken, strict=False)
        ]

    def _without(self, floor: FreeFloor, half: Floats, place: Floats) -> FreeFloor:
        asked = floor, *half[:2].tolist(), *place[[0, 1, 3]].tolist()
        if asked not in self._asked:
            self._asked[asked] = floor.without(place[:2], half[:2], float(place[3]))
        return self._asked[asked]

    def _is_in_the_way(self, half: Floats, place: Floats) -> tuple[bool, bool]:
        low = place[2] + half[2] - self.ground <= HEAD
        return low and place[2] + 2 * half[2] - self.ground > STEP, low

    def kept(self, placeable: Placeable, place: Floats) -> int:
        """One of :data:`CUTS`, :data:`ROUND` and :data:`CLEAR` for a thing at a place (4,)."""
        after = self._with(placeable.half, place)
        found = [old is new or _whole(old, new) for old, new in zip(self.floors, after, strict=True)]
        return CLEAR if all(found) else ROUND if found[0] else CUTS

    def best(self, placeable: Placeable, places: Floats, good: Bools) -> int:
        """The first of the ``good`` places (T, 4) that is :data:`CLEAR`, else that does not cut the floor, else -1."""
        if not self.wanted or not self.floors:
            return int(good.argmax()) if good.any() else -1
        other = -1
        for number in np.flatnonzero(good).tolist():
            kept = self.kept(placeable, places[number])
            if kept == CLEAR:
                return number
            other = number if kept == ROUND and other < 0 else other
        return other


def _whole(before: FreeFloor, after: FreeFloor) -> bool:
    """Is a floor with one more thing still in one piece, or in as few as before?"""
    return after.reachable >= min(REACHABLE, before.reachable) - 1e-9 and after.places <= max(before.places, 1)
