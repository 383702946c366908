"""What room is taken: boxes turned about the vertical, tested many poses at a time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

TOUCH = 0.001
"""Boxes that share less height than this stand on each other, metres."""


class Occupancy:
    """The boxes placed so far, in world coordinates; each has an owner (a number), keep-out zones have -1."""

    def __init__(self) -> None:
        self._count = 0
        self._center = np.empty((256, 3))
        self._half = np.empty((256, 3))
        self._turn = np.empty((256, 2))  # cosine and sine of the yaw
        self._owner = np.empty(256, np.int64)

    def add(self, parts: NDArray[np.float64], pose: NDArray[np.float64], owner: int) -> None:
        """Enter the parts (K, 2, 3) of an asset that stands at ``pose`` (x, y, z, yaw)."""
        center, half, turn = _in_world(parts, pose[None])
        stop = self._count + len(parts)
        while stop > len(self._owner):
            for name in ("_center", "_half", "_turn", "_owner"):
                column = getattr(self, name)
                setattr(self, name, np.concatenate([column, np.empty_like(column)]))
        rows = slice(self._count, stop)
        self._center[rows], self._half[rows], self._turn[rows], self._owner[rows] = center[0], half, turn, owner
        self._count = stop

    def drop_zones(self) -> None:
        """Forget the keep-out zones."""
        kept = np.flatnonzero(self._owner[: self._count] >= 0)
        for column in (self._center, self._half, self._turn, self._owner):
            column[: len(kept)] = column[kept]
        self._count = len(kept)

    def free(
        self, parts: NDArray[np.float64], poses: NDArray[np.float64], ignore: int = -2, clearance: float = 0.0
    ) -> NDArray[np.bool_]:
        """At which poses (T, 4: x, y, z, yaw) the parts (K, 2, 3) meet nothing, bool (T,).

        ``ignore`` is an owner that may be met (what the thing stands in or on);
        ``clearance`` is kept free around, horizontally, metres.
        """
        center, half, turn = _in_world(parts, poses)
        reach = np.hypot(half[:, 0], half[:, 1])
        reach = np.stack([reach, reach, half[:, 2]], axis=1) + np.array([clearance, clearance, 0.0])
        low, high = (center - reach).min(axis=(0, 1)), (center + reach).max(axis=(0, 1))
        mine = self._half[: self._count]
        spread = np.hypot(mine[:, 0], mine[:, 1])
        place = self._center[: self._count]
        near = (place[:, 0] - spread < high[0]) & (place[:, 0] + spread > low[0])
        near &= (place[:, 1] - spread < high[1]) & (place[:, 1] + spread > low[1])
        near &= (place[:, 2] - mine[:, 2] < high[2] - TOUCH) & (place[:, 2] + mine[:, 2] > low[2] + TOUCH)
        near &= self._owner[: self._count] != ignore
        rows = np.flatnonzero(near)
        if not len(rows):
            return np.ones(len(poses), bool)
        hit = _meet(
            center[:, :, None], half[:, None], turn[:, None, None],
            self._center[rows], self._half[rows], self._turn[rows], clearance,
        )  # fmt: skip
        return ~hit.any(axis=(1, 2))


def _in_world(
    parts: NDArray[np.float64], poses: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Centres (T, K, 3), half sizes (K, 3) and turns (T, 2) of parts at poses."""
    middle, half = parts.mean(axis=1), (parts[:, 1] - parts[:, 0]) / 2
    cos, sin = np.cos(poses[:, 3]), np.sin(poses[:, 3])
    x, y = middle[:, 0], middle[:, 1]
    center = np.empty((len(poses), len(parts), 3))
    center[:, :, 0] = poses[:, :1] + cos[:, None] * x - sin[:, None] * y
    center[:, :, 1] = poses[:, 1:2] + sin[:, None] * x + cos[:, None] * y
    center[:, :, 2] = poses[:, 2:3] + middle[:, 2]
    return center, half, np.stack([cos, sin], axis=1)


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
