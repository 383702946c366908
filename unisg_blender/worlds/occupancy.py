"""What room is taken: boxes turned about the vertical, tested many poses at a time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

TOUCH = 0.001
"""Boxes that share less height than this stand on each other, metres."""


class Shapes(NamedTuple):
    """The parts of an asset in its frame: their middles (K, 3) and half sizes (K, 3)."""

    middle: NDArray[np.float64]
    half: NDArray[np.float64]


class Occupancy:
    """The boxes placed so far, in world coordinates; each has an owner (a number), keep-out zones have -1."""

    def __init__(self) -> None:
        self._count = 0
        self._center = np.empty((512, 3))
        self._half = np.empty((512, 3))
        self._turn = np.empty((512, 2))  # cosine and sine of the yaw
        self._owner = np.empty(512, np.int64)
        self._extent = np.empty((6, 512))  # along the world's axes: lowest x, y, z, highest x, y, z

    def add(self, shapes: Shapes, pose: NDArray[np.float64], owner: int) -> None:
        """Enter the parts of an asset that stands at ``pose`` (x, y, z, yaw)."""
        center, reach, turn = _in_world(shapes, pose[None])
        stop = self._count + len(shapes.half)
        while stop > len(self._owner):
            for name in ("_center", "_half", "_turn", "_owner"):
                column = getattr(self, name)
                setattr(self, name, np.concatenate([column, np.empty_like(column)]))
            self._extent = np.concatenate([self._extent, np.empty_like(self._extent)], axis=1)
        rows = slice(self._count, stop)
        self._center[rows], self._half[rows], self._turn[rows], self._owner[rows] = center[0], shapes.half, turn, owner
        self._extent[:3, rows], self._extent[3:, rows] = (center[0] - reach[0]).T, (center[0] + reach[0]).T
        self._count = stop

    def free(
        self, shapes: Shapes, poses: NDArray[np.float64], ignore: int = -2, clearance: float = 0.0
    ) -> NDArray[np.bool_]:
        """At which poses (T, 4: x, y, z, yaw) the parts meet nothing, bool (T,).

        ``ignore`` is an owner that may be met (what the object stands in or on);
        ``clearance`` is kept free around, horizontally, metres.
        """
        if not len(poses):
            return np.zeros(0, bool)
        center, reach, turn = _in_world(shapes, poses)
        reach = reach + np.array([clearance, clearance, -TOUCH])
        low, high = (center - reach).min(axis=0), (center + reach).max(axis=0)
        first, last, taken = low.min(axis=0), high.max(axis=0), self._extent[:, : self._count]
        near = self._owner[: self._count] != ignore
        for axis in range(3):
            near &= (taken[axis] < last[axis]) & (taken[3 + axis] > first[axis])
        rows = np.flatnonzero(near)
        if not len(rows):
            return np.ones(len(poses), bool)
        bottom, top = taken[:3, rows].T, taken[3:, rows].T
        part, other = np.nonzero(((bottom < high[:, None]) & (top > low[:, None])).all(axis=2))
        if not len(part):
            return np.ones(len(poses), bool)
        hit = _meet(
            center[:, part], shapes.half[part], turn[:, None],
            self._center[rows][other], self._half[rows][other], self._turn[rows][other], clearance,
        )  # fmt: skip
        return ~hit.any(axis=1)


def _in_world(
    shapes: Shapes, poses: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Centres (T, K, 3), half sizes along the world's axes (T, K, 3) and turns (T, 2) of parts at poses."""
    turn = np.empty((len(poses), 2))
    turn[:, 0], turn[:, 1] = np.cos(poses[:, 3]), np.sin(poses[:, 3])
    matrix = np.zeros((len(poses), 3, 3))
    matrix[:, 0, 0] = matrix[:, 1, 1] = turn[:, 0]
    matrix[:, 1, 0], matrix[:, 0, 1], matrix[:, 2, 2] = turn[:, 1], -turn[:, 1], 1.0
    flipped = matrix.transpose(0, 2, 1)
    return shapes.middle @ flipped + poses[:, None, :3], shapes.half @ np.abs(flipped), turn


def _meet(
    a_center: NDArray[np.float64], a_half: NDArray[np.float64], a_turn: NDArray[np.float64],
    b_center: NDArray[np.float64], b_half: NDArray[np.float64], b_turn: NDArray[np.float64], clearance: float,
) -> NDArray[np.bool_]:  # fmt: skip
    """Separating axes of two rectangles on top of each other's height range; broadcasts."""
    dx, dy = b_center[..., 0] - a_center[..., 0], b_center[..., 1] - a_center[..., 1]
    dz = np.abs(b_center[..., 2] - a_center[..., 2])
    hit = dz < a_half[..., 2] + b_half[..., 2] - TOUCH
    cos = np.abs(a_turn[..., 0] * b_turn[..., 0] + a_turn[..., 1] * b_turn[..., 1])
    sin = np.abs(a_turn[..., 0] * b_turn[..., 1] - a_turn[..., 1] * b_turn[..., 0])
    ax, ay, bx, by = a_half[..., 0], a_half[..., 1], b_half[..., 0], b_half[..., 1]
    for turn, along, across in ((a_turn, ax + cos * bx + sin * by, ay + sin * bx + cos * by),
                                (b_turn, bx + cos * ax + sin * ay, by + sin * ax + cos * ay)):  # fmt: skip
        hit = hit & (np.abs(turn[..., 0] * dx + turn[..., 1] * dy) < along + clearance)
        hit = hit & (np.abs(turn[..., 0] * dy - turn[..., 1] * dx) < across + clearance)
    return hit
