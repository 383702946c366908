"""What room is taken: boxes turned about the vertical, tested many poses at a time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Bools, Floats
from ..geometry.planar import rectangle_gap, rotation

TOUCH = 0.001
"""Boxes that share less height than this stand on each other, metres."""


class Shapes(NamedTuple):
    """The parts of an asset in its frame: their middles (K, 3) and half sizes (K, 3)."""

    middle: Floats
    half: Floats


class Occupancy:
    """The boxes placed so far, in world coordinates; each has an owner (a number), keep-out zones have -1."""

    def __init__(self) -> None:
        self._count = 0
        self._center = np.empty((512, 3))
        self._half = np.empty((512, 3))
        self._turn = np.empty(512)
        self._owner = np.empty(512, np.int64)
        self._extent = np.empty((6, 512))  # along the world's axes: lowest x, y, z, highest x, y, z

    def add(self, shapes: Shapes, pose: Floats, owner: int) -> None:
        """Enter the parts of an asset that stands at ``pose`` (x, y, z, yaw)."""
        center, reach = _in_world(shapes, pose[None])
        stop = self._count + len(shapes.half)
        while stop > len(self._owner):
            for name in ("_center", "_half", "_turn", "_owner"):
                column = getattr(self, name)
                setattr(self, name, np.concatenate([column, np.empty_like(column)]))
            self._extent = np.concatenate([self._extent, np.empty_like(self._extent)], axis=1)
        rows = slice(self._count, stop)
        self._center[rows], self._half[rows], self._turn[rows], self._owner[rows] = (
            center[0],
            shapes.half,
            pose[3],
            owner,
        )
        self._extent[:3, rows], self._extent[3:, rows] = (center[0] - reach[0]).T, (center[0] + reach[0]).T
        self._count = stop

    def free(
        self, shapes: Shapes, poses: Floats, ignore: int = -2, clearance: float = 0.0, asked: Bools | None = None
    ) -> Bools:
        """At which poses (T, 4: x, y, z, yaw) the parts meet nothing, bool (T,).

        ``ignore`` is an owner that may be met (what the object stands in or on);
        ``clearance`` is kept free around, horizontally, metres. Of poses that are not ``asked`` for (T,), the answer
        is no.
        """
        found = np.ones(len(poses), bool) if asked is None else asked
        if not found.any():
            return found
        center, reach = _in_world(shapes, poses)
        reach = reach + np.array([clearance, clearance, -TOUCH])
        low, high = (center - reach).min(axis=0), (center + reach).max(axis=0)
        first, last, taken = low.min(axis=0), high.max(axis=0), self._extent[:, : self._count]
        near = self._owner[: self._count] != ignore
        for axis in range(3):
            near &= (taken[axis] < last[axis]) & (taken[3 + axis] > first[axis])
        rows = np.flatnonzero(near)
        if not len(rows):
            return found
        bottom, top = taken[:3, rows], taken[3:, rows]
        meeting = np.ones((len(low), len(rows)), bool)
        for axis in range(3):
            meeting &= (bottom[axis] < high[:, axis, None]) & (top[axis] > low[:, axis, None])
        part, other = np.nonzero(meeting)
        if not len(part):
            return found
        rows, half, mine = rows[other], shapes.half[part], np.flatnonzero(found)
        offset = self._center[rows] - center[np.ix_(mine, part)]
        hit = np.abs(offset[..., 2]) < half[:, 2] + self._half[rows, 2] - TOUCH
        turn = poses[mine, 3, None]
        hit &= rectangle_gap(offset[..., :2], turn, half, self._turn[rows], self._half[rows]) < clearance
        result = np.zeros(len(poses), bool)
        result[mine] = ~hit.any(axis=1)
        return result


def _in_world(shapes: Shapes, poses: Floats) -> tuple[Floats, Floats]:
    """Centres (T, K, 3) and half sizes along the world's axes (T, K, 3) of parts at poses."""
    flipped = rotation(poses[:, 3]).transpose(0, 2, 1)
    return shapes.middle @ flipped + poses[:, None, :3], shapes.half @ np.abs(flipped)
