"""What is the same of a room for whatever comes next: its ground, its middle, its walls, and what stands on what."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.planar import rotate
from ...spatial.supports import levels_of

THIN, LONG, TALL = 0.15, 0.5, 0.6
"""Half extents in metres: what is thinner, longer and taller counts as a wall."""

FLAT = 0.3
"""A root lower than twice this, in metres, is a floor."""


@dataclass(frozen=True, eq=False)
class RoomShape:
    """The room around K objects.

    Attributes
    ----------
    middle, ground
        (2,) and height, metres: middle of the largest root, and its upper side, on which furniture stands, if it is
        flat; 0 where there is none.
    level
        int64 (K,): number of supports under each object.
    swap
        bool (K,): walls whose thin side is along x.
    inner
        (K,): on which side of a wall the room is: 1 towards y, -1 away, 0 for what is no wall.
    """

    middle: Floats
    ground: float
    level: Ints
    swap: Bools
    inner: Floats

    @staticmethod
    def of(support: Ints, center: Floats, half: Floats, yaw: Floats) -> RoomShape:
        """The room of objects with supports (K,) and upright boxes (K, 3), (K, 3), (K,)."""
        roots = np.flatnonzero(support < 0)
        root = int(roots[np.argmax(half[roots, 0] * half[roots, 1])]) if len(roots) else -1
        middle = center[root, :2] if root >= 0 else np.zeros(2)
        ground = float(center[root, 2] + half[root, 2]) if root >= 0 and half[root, 2] < FLAT else 0.0
        wall = (half[:, :2].min(axis=1, initial=np.inf) < THIN) & (half[:, :2].max(axis=1, initial=0) > LONG)
        wall &= half[:, 2] > TALL
        swap = wall & (half[:, 0] < half[:, 1])
        side = rotate(middle - center[:, :2], -(yaw + swap * (np.pi / 2)))[:, 1]
        inner = np.where(wall, np.where(side >= 0, 1.0, -1.0), 0.0)
        return RoomShape(middle, ground, levels_of(support), swap, inner)
