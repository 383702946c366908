"""The floor of a room on which people can walk between things, and how much of it they can reach from one place."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..geometry.arrays import Bools, Floats
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


@dataclass(frozen=True, eq=False)
class FreeFloor:
    """A floor with the cells on which the middle of whoever walks may be.

    Attributes
    ----------
    grid
        Its cells.
    width
        Metres across of whoever walks.
    free
        Of the grid's shape: cells over the floor, half the width from its rim and from things.
    """

    grid: Grid
    width: float
    free: Bools

    @staticmethod
    def of(outline: Floats, width: float = WIDTH) -> FreeFloor:
        """The floor within an outline (K, 2), metres, with nothing on it."""
        low, high = outline.min(axis=0), outline.max(axis=0)
        grid = Grid.around(low, high, max(float((high - low).max()) / CELLS, FINEST))
        middles = grid.middles_of(np.arange(grid.size))
        free = inside(outline, middles)
        free[free] = np.linalg.norm(to_edges(outline, middles[free]), axis=-1).min(axis=-1) >= width / 2
        return FreeFloor(grid, width, free.reshape(grid.shape))

    def without(self, center: Floats, half: Floats, yaw: float) -> FreeFloor:
        """The floor with a thing on it: a box with middle (2,) and half extents (2,), turned; metres, radians."""
        reach = float(np.hypot(*half)) + self.width
        ends = np.array([center - reach, center + reach]) - self.grid.origin
        first, last = np.clip((ends / self.grid.cell).astype(int) + np.array([[0], [1]]), 0, self.grid.shape)
        near = (slice(first[0], last[0]), slice(first[1], last[1]))
        away = outside_rectangle(self._middles[near] - center, yaw, half)
        free = self.free.copy()
        free[near] &= away > self.width / 2
        return FreeFloor(self.grid, self.width, free)

    @cached_property
    def _middles(self) -> Floats:
        return self.grid.middles_of(np.arange(self.grid.size)).reshape(*self.grid.shape, 2)

    @cached_property
    def areas(self) -> Floats:
        """Square metres of each connected part of the free floor."""
        from scipy.ndimage import label

        parts: Any = label(self.free, np.ones((3, 3)))[0]
        return np.bincount(parts.reshape(-1))[1:] * self.grid.cell**2

    @property
    def places(self) -> int:
        """How many of these parts are as large as :data:`PLACE`."""
        return int((self.areas >= PLACE).sum())

    @property
    def reachable(self) -> float:
        """The share of the free floor that is in its largest connected part; 1 where nothing is free."""
        return float(self.areas.max() / self.areas.sum()) if len(self.areas) else 1.0
