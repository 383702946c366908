"""The space of a scene that is being filled: what takes it up, and where there is room."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.box_overlap import penetration
from ...geometry.boxes import Boxes, world_bounds
from ...geometry.planar import footprints
from ...geometry.polygon import outside_distance
from ..observe.placeable import Placeable
from ..observe.prior_tables import PriorTables

TOUCH = 0.001
"""Metres that boxes may reach into each other anyway."""


NOBODY = -1
"""Whose the faces of a building are: of no object."""


class FreeSpace:
    """World boxes of all parts with whose they are, and the outline of the room.

    Parameters
    ----------
    parts, owner
        World boxes of the parts and int64 (P,) the object that each belongs to.
    category
        int64 (K,): the objects' categories as the tables number them, -1 for others.
    outline
        Outline of the room (M, 2) in world metres, None if there is none.
    """

    def __init__(self, parts: Boxes, owner: Ints, category: Ints, outline: Floats | None, tables: PriorTables) -> None:
        self.boxes = parts
        self.owner = owner
        self.category = category
        self.outline = outline
        self.tables = tables
        self.low, self.high = world_bounds(parts)

    def add(self, parts: Boxes, category: int) -> int:
        """Take up space with a new object; returns its number."""
        number = len(self.category)
        self.category = np.append(self.category, category)
        self.take_up(parts, number)
        return number

    def take_up(self, parts: Boxes, number: int) -> None:
        """Take up space with parts of an object."""
        low, high = world_bounds(parts)
        self.boxes = Boxes(
            np.concatenate([self.boxes.center, parts.center]),
            np.concatenate([self.boxes.axes, parts.axes]),
            np.concatenate([self.boxes.half, parts.half]),
            np.concatenate([self.boxes.solid, parts.solid]),
        )
        self.owner = np.append(self.owner, np.full(len(parts.center), number))
        self.low, self.high = np.concatenate([self.low, low]), np.concatenate([self.high, high])

    def parts_of(self, obj: int) -> Boxes:
        """The parts of an object."""
        return self.boxes.take(np.flatnonzero(self.owner == obj))

    def depth(self, placeable: Placeable, places: Floats, category: int, support: int = -1) -> Floats:
        """Metres (T,) by which a placeable at places (T, 4) reaches too deep into anything; 0 where it fits.

        ``support`` is the object that holds it: some reach into what they lie in.
        """
        found = np.zeros(len(places))
        boxes = placeable.boxes_at(places)
        count = len(boxes.center) // max(len(places), 1)
        if not count or not len(self.low):
            return found
        low, high = world_bounds(boxes)
        near = np.flatnonzero(((self.low < high.max(axis=0)) & (self.high > low.min(axis=0))).all(axis=1))
        mine, other = np.nonzero(_meeting(low, high, self.low[near], self.high[near]))
        if len(mine):
            other = near[other]
            owner = self.owner[other]
            pair = category, np.append(self.category, -1)[owner]
            limit = np.where(owner == support, self.tables.held_overlaps[pair], self.tables.overlaps[pair])
            excess = penetration(boxes.take(mine), self.boxes.take(other)) - limit - TOUCH
            np.maximum.at(found, mine // count, np.maximum(excess, 0))
        return found

    def outside(self, placeable: Placeable, places: Floats) -> Floats:
        """Metres (T,) by which the footprint at places (T, 4) leaves the room; 0 without an outline."""
        if self.outline is None:
            return np.zeros(len(places))
        return outside_distance(self.outline, footprints(placeable.half, places)).max(axis=1)


def _meeting(low: Floats, high: Floats, other_low: Floats, other_high: Floats) -> Bools:
    """Which of N upright boxes overlap which of M others, bool (N, M); axis by axis: numpy is slow at rows of three."""
    hit = np.ones((len(low), len(other_low)), bool)
    for axis in range(3):
        hit &= (low[:, None, axis] < other_high[:, axis]) & (high[:, None, axis] > other_low[:, axis])
    return hit
