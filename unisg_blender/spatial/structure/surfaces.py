"""Surfaces in rooms that can hold things: table tops, boards, counters, whoever's mesh they are part of."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Floats, Ints
from ...geometry.column_raster import Grid
from ...geometry.traced_outlines import outlines_of, simplified_all
from .scan import FreeSpans, Scan, free_spans
from .storeys import Region
from .structure import HoldingSurface

LOWEST, HIGHEST = 0.1, 2.2
"""Metres over the floor between which surfaces are looked for."""

CLEAR = 0.12
"""Metres that are free over a surface, at least."""

SAME_HEIGHT = 0.02
"""Metres of height within which cells are one surface."""

SMALLEST, NARROWEST = 0.04, 0.1
"""Square metres of a surface at least, and metres of its mean width: what is narrower is an edge."""

FLAT = 0.97
"""Upward part of the unit normal of what things stand on, at least: they roll off balls and backs."""


def holding_surfaces(scan: Scan, regions: list[Region]) -> list[HoldingSurface]:
    """The surfaces in some rooms, room by room from below."""
    spans = free_spans(scan.all_columns, scan.up)
    clear = np.flatnonzero((spans.high - spans.low >= CLEAR) & (np.abs(scan.slope[spans.triangle]) >= FLAT))
    columns = scan.grid.shape[1]
    found: list[HoldingSurface] = []
    for number, region in enumerate(regions):
        rows = np.array([region.first[0], region.first[0] + region.mask.shape[0]]) * columns
        first, last = np.searchsorted(spans.cell[clear], rows)
        near = clear[first:last]
        over = spans.low[near] - region.floor
        near = near[(over >= LOWEST) & (over <= HIGHEST)]
        found += _surfaces_of(scan, spans, near[region.over(spans.cell[near], columns)], number)
    return sorted(found, key=lambda surface: (surface.room, surface.row, surface.height))


def _surfaces_of(scan: Scan, spans: FreeSpans, mine: Ints, room: int) -> list[HoldingSurface]:
    """The surfaces that some spans stand on, by entity, height and what is connected."""
    if not len(mine):
        return []
    row, low = scan.row[spans.triangle[mine]], spans.low[mine]
    order = np.lexsort((low, row))
    group = np.cumsum((np.diff(row[order], prepend=-1) != 0) | (np.diff(low[order], prepend=-np.inf) > SAME_HEIGHT))
    large = np.bincount(group) * scan.grid.cell**2 >= SMALLEST
    order, group = order[large[group]], group[large[group]]
    part, size = _connected(group, spans.cell[mine[order]], scan.grid)
    extent = _extents(part, spans.cell[mine[order]], scan.grid)
    large = (size * scan.grid.cell**2 >= SMALLEST) & (size * scan.grid.cell**2 >= NARROWEST * extent)
    number = np.cumsum(large) - 1
    order, part = order[large[part]], number[part[large[part]]]
    if not len(order):
        return []
    once = np.unique(part * scan.grid.size + spans.cell[mine[order]], return_index=True)[1]
    order, part = order[once], part[once]
    i, j = np.divmod(spans.cell[mine[order]], scan.grid.shape[1])
    around = [loops[0] for loops in outlines_of(part, i, j, scan.grid)]
    heights = _medians(part, low[order])
    free = _medians(part, (spans.high - spans.low)[mine[order]])
    rows = row[order[np.unique(part, return_index=True)[1]]]
    return [
        HoldingSurface(int(row), outline, float(height), float(above), room)
        for row, outline, height, above in zip(
            rows, simplified_all(around, 1.5 * scan.grid.cell), heights, free, strict=True
        )
    ]


def _connected(group: Ints, cell: Ints, grid: Grid) -> tuple[Ints, Ints]:
    """Numbers of the parts of groups of cells that share sides, from 0, and the number of cells of each."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    key, place = np.unique(group * grid.size + cell, return_inverse=True)
    pairs = []
    for step in (1, grid.shape[1]):
        after = np.searchsorted(key, key + step).clip(max=len(key) - 1)
        pairs.append(np.stack([np.arange(len(key)), after])[:, key[after] == key + step])
    one, two = np.concatenate(pairs, axis=1)
    links = coo_array((np.ones(len(one), bool), (one, two)), shape=(len(key), len(key)))
    part = np.asarray(connected_components(links, directed=False)[1], np.int64)
    return part[place], np.bincount(part)


def _extents(part: Ints, cell: Ints, grid: Grid) -> Floats:
    """How long each part is along x or y, whichever is more, metres."""
    count = int(part.max(initial=-1)) + 1
    longest = np.zeros(count)
    for place in np.divmod(cell, grid.shape[1]):
        low, high = np.full(count, grid.size), np.full(count, -1)
        np.minimum.at(low, part, place)
        np.maximum.at(high, part, place)
        longest = np.maximum(longest, (high - low + 1) * grid.cell)
    return longest


def _medians(part: Ints, values: Floats) -> Floats:
    """The median of the values of each part, of parts numbered from 0; inf where most are."""
    order = np.lexsort((values, part))
    count = np.bincount(part)
    first = np.cumsum(count) - count
    ordered = values[order]
    return (ordered[first + (count - 1) // 2] + ordered[first + count // 2]) / 2
