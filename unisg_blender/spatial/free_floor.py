"""The floor of a room on which people can walk between things, and how much of it they can reach from one place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..geometry.arrays import Bools, Floats, Ints
from ..geometry.column_raster import Grid
from ..geometry.planar import outside_rectangle
from ..geometry.polygon import inside, to_edges

WIDTH = 0.2
"""Metres across of whoever walks: SceneEval's and PhyScene's robot."""

HEAD = 2.0
"""Metres over the floor from which on the middle of a thing is out of the way."""

STEP = 0.12
"""Metres over the floor up to which a thing, such as a rug, is walked over."""

PLACE = 1.0
"""Square metres of a place that is not to be cut off."""

CELLS = 160
"""Cells along the longer side of a room, at most."""

FINEST = 0.025
"""Metres of a cell, at least."""


NEIGHBOURS = np.ones((3, 3))
"""A cell is next to those at its corners, too."""


@dataclass(frozen=True, eq=False)
class FreeFloor:
    """A floor with the cells on which the middle of whoever walks may be.

    Attributes
    ----------
    grid
        Its cells.
    width
        Metres across of whoever walks.
    middles
        Where the middles of the cells are, metres, (X, Y, 2).
    parts
        (X, Y): which connected part of the floor each cell is in, from 1 on; 0 where nobody can be: beside the floor,
        or half the width from its rim or from things.
    sizes
        Cells in each part: 0 in those that things have covered.
    """

    grid: Grid
    width: float
    middles: Floats
    parts: Ints
    sizes: Ints

    @staticmethod
    def of(outline: Floats, width: float = WIDTH) -> FreeFloor:
        """The floor within an outline (K, 2), metres, with nothing on it."""
        low, high = outline.min(axis=0), outline.max(axis=0)
        grid = Grid.around(low, high, max(float((high - low).max()) / CELLS, FINEST))
        middles = grid.middles_of(np.arange(grid.size))
        free = inside(outline, middles)
        free[free] = np.linalg.norm(to_edges(outline, middles[free]), axis=-1).min(axis=-1) >= width / 2
        return FreeFloor(grid, width, middles.reshape(*grid.shape, 2), *_connected(free.reshape(grid.shape)))

    def without(self, center: Floats, half: Floats, yaw: float) -> FreeFloor:
        """The floor with a thing on it: a box with middle (2,) and half extents (2,), turned; metres, radians."""
        reach = float(np.hypot(*half)) + self.width
        ends = np.array([center - reach, center + reach]) - self.grid.origin
        first, last = np.clip((ends / self.grid.cell).astype(int) + np.array([[0], [1]]), 0, self.grid.shape)
        near = (slice(first[0], last[0]), slice(first[1], last[1]))
        away = outside_rectangle(self.middles[near] - center, yaw, half)
        covered = (self.parts[near] > 0) & (away <= self.width / 2)
        if not covered.any():
            return self
        parts = self.parts.copy()
        parts[near][covered] = 0
        sizes = self.sizes - np.bincount(self.parts[near][covered] - 1, minlength=len(self.sizes))
        around = (slice(max(first[0] - 1, 0), last[0] + 1), slice(max(first[1] - 1, 0), last[1] + 1))
        if _falls_apart(self.parts[around] > 0, parts[around] > 0):
            parts, sizes = _connected(parts > 0)
        return FreeFloor(self.grid, self.width, self.middles, parts, sizes)

    @property
    def places(self) -> int:
        """How many of the parts are as large as :data:`PLACE`."""
        return int((self.sizes * self.grid.cell**2 >= PLACE).sum())

    @property
    def reachable(self) -> float:
        """The share of the free floor that is in its largest connected part; 1 where nothing is free."""
        return float(self.sizes.max() / self.sizes.sum()) if self.sizes.any() else 1.0


def _connected(free: Bools) -> tuple[Ints, Ints]:
    """Which connected part each free cell is in, from 1 on, and how many cells each part has."""
    from scipy.ndimage import label

    parts: Any = label(free, NEIGHBOURS)[0]
    return parts, np.bincount(parts.reshape(-1))[1:]


def _falls_apart(before: Bools, after: Bools) -> bool:
    """May parts fall into several where cells are covered? Not where all that hung together around them still does."""
    from scipy.ndimage import label

    parts: Any = label(before, NEIGHBOURS)[0]
    return int(label(after, NEIGHBOURS)[1]) != len(np.unique(parts[after]))
