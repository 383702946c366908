"""Surfaces in rooms that can hold things: table tops, boards, counters, whoever's mesh they are part of."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Floats, Ints
from ...geometry.column_raster import Grid
from ...geometry.mask_outline import components, outlines, simplified
from .scan import Scan, free_spans
from .storeys import Region
from .structure import HoldingSurface

LOWEST, HIGHEST = 0.1, 2.2
"""Metres over the floor between which surfaces are looked for."""

CLEAR = 0.12
"""Metres that are free over a surface, at least."""

SAME_HEIGHT = 0.02
"""Metres of height within which cells are one surface."""

SMALLEST = 0.04
"""Square metres of a surface at least."""


def holding_surfaces(scan: Scan, regions: list[Region]) -> list[HoldingSurface]:
    """The surfaces in some rooms, room by room from below."""
    grid, spans = scan.grid, free_spans(scan.all_columns, scan.up)
    clear = np.flatnonzero(spans.high - spans.low >= CLEAR)
    row, low, cell = scan.row[spans.triangle[clear]], spans.low[clear], spans.cell[clear]
    headroom = spans.high[clear] - low
    found: list[HoldingSurface] = []
    for number, region in enumerate(regions):
        over = low - region.floor
        mine = np.flatnonzero((over >= LOWEST) & (over <= HIGHEST) & region.over(cell, grid.shape[1]))
        for group in _groups(row[mine], low[mine]):
            for part in _connected(mine[group], cell, grid):
                if len(part) * grid.cell**2 >= SMALLEST:
                    outline = simplified(outlines(grid.mask(cell[part]), grid)[0], 1.5 * grid.cell)
                    height, free = float(np.median(low[part])), float(np.median(headroom[part]))
                    found.append(HoldingSurface(int(row[part[0]]), outline, height, free, number))
    return sorted(found, key=lambda surface: (surface.room, surface.row, surface.height))


def _groups(row: Ints, low: Floats) -> list[Ints]:
    """Numbers of cells of the same entity at the same height."""
    order = np.lexsort((low, row))
    if not len(order):
        return []
    new = (np.diff(row[order]) != 0) | (np.diff(low[order]) > SAME_HEIGHT)
    return np.split(order, np.flatnonzero(new) + 1)


def _connected(group: Ints, cell: Ints, grid: Grid) -> list[Ints]:
    """A group of cells, parted where they do not share sides."""
    if len(group) * grid.cell**2 < SMALLEST:
        return []
    i, j = np.divmod(cell[group], grid.shape[1])
    i, j = i - i.min(), j - j.min()
    mask = np.zeros((i.max() + 1, j.max() + 1), bool)
    mask[i, j] = True
    number, count = components(mask)
    return [group[number[i, j] == part] for part in range(1, count + 1)]
