"""A room, or an open place, as cells of the scan's grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.column_raster import Grid
from .looks import slices


@dataclass(frozen=True, eq=False)
class Region:
    """A room as cells: bool ``mask`` of the shape of ``grid``, the part of the scan's grid that begins at ``first``.

    Heights of floor, ceiling (inf for none) and lintels in metres. ``cuts`` are the walls at some heights over the
    floor: segments (S, 2, 2) and the rows (S,) of their entities.
    """

    mask: Bools
    grid: Grid
    first: tuple[int, int]
    floor: float
    ceiling: float
    lintel: float
    indoors: bool
    floor_row: int
    ceiling_row: int
    cuts: dict[float, tuple[Floats, Ints]]

    @property
    def slices(self) -> tuple[slice, slice]:
        """Where the mask lies in the scan's grid."""
        return slices(self.first, self.mask.shape)

    def over(self, cells: Ints, columns: int) -> Bools:
        """Which cells of the scan's grid, which has so many along y, are in the room."""
        i, j = np.divmod(cells, columns)
        i, j = i - self.first[0], j - self.first[1]
        near = (i >= 0) & (j >= 0) & (i < self.mask.shape[0]) & (j < self.mask.shape[1])
        near[near] = self.mask[i[near], j[near]]
        return near

    def holds(self, points: Floats) -> Bools:
        """Which points (N, 2) are in the room."""
        cells = self.grid.at(points)
        return np.asarray((cells >= 0) & self.mask.reshape(-1)[cells])
