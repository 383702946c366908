"""Surfaces in rooms that can hold things: table tops, boards, counters, whoever's mesh they are part of."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Floats, Ints
from ...geometry.column_raster import Crossings, Grid, columns
from ...geometry.grouped_ends import grouped_ends
from ...geometry.surface_contact import STEEPEST
from ...geometry.traced_outlines import outlines_of, simplified_all
from .region import Region
from .scan import FINEST, Scan, free_spans
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
    """The surfaces in some rooms, room by room from below; whatever the scan's cells, they are told by the finest."""
    corners = np.array(scan.grid.origin), np.array(scan.grid.origin) + np.array(scan.grid.shape) * scan.grid.cell
    grid = scan.grid if scan.grid.cell <= FINEST else Grid.around(*corners, FINEST)
    level = _between_floors(scan, regions)
    met = columns(scan.triangles[level], grid)
    spans = free_spans(Crossings(met.cell, met.height, level[met.triangle]), scan.up)
    clear = np.flatnonzero((spans.high - spans.low >= CLEAR) & (np.abs(scan.slope[spans.triangle]) >= FLAT))
    parts: list[tuple[Ints, Floats, Ints]] = [(np.zeros(0, np.int64), np.zeros(0), np.zeros(0, np.int64))]
    for number, region in enumerate(regions):
        low = np.array(region.grid.origin) - grid.origin
        high = low + np.array(region.grid.shape) * region.grid.cell
        first, last = np.clip(np.array([low[0], high[0]]) / grid.cell + (-1, 2), 0, grid.shape[0]).astype(int)
        near = clear[slice(*np.searchsorted(spans.cell[clear], (first * grid.shape[1], last * grid.shape[1])))]
        over = spans.low[near] - region.floor
        near = near[(over >= LOWEST) & (over <= HIGHEST)]
        mine = near[region.holds(grid.middles_of(spans.cell[near]))]
        headroom = np.minimum(spans.high[mine], region.ceiling) - spans.low[mine]
        parts.append((mine, headroom, np.full(len(mine), number)))
    mine, headroom, room = (np.concatenate(column) for column in zip(*parts, strict=True))
    found = _surfaces_of(grid, spans.cell[mine], scan.row[spans.triangle[mine]], spans.low[mine], headroom, room)
    return sorted(found, key=lambda surface: (surface.room, surface.row, surface.height))


def _between_floors(scan: Scan, regions: list[Region]) -> Ints:
    """Triangles that are no walls, over some floor and not much over where surfaces are looked for."""
    low, high = scan.ends
    chosen = np.zeros(len(low), bool)
    for floor in {region.floor for region in regions}:
        chosen |= (high >= floor + LOWEST) & (low <= floor + HIGHEST + CLEAR)
    return np.flatnonzero(chosen & (np.abs(scan.slope) > STEEPEST))


def _surfaces_of(
    grid: Grid, cell: Ints, row: Ints, low: Floats, headroom: Floats, room: Ints
) -> list[HoldingSurface]:  # fmt: skip
    """The surfaces at some cells, by room, entity, height and what is connected."""
    order = np.lexsort((low, row, room))
    new = (np.diff(row[order], prepend=-1) != 0) | (np.diff(room[order], prepend=-1) != 0)
    group = np.cumsum(new | (np.diff(low[order], prepend=-np.inf) > SAME_HEIGHT))
    large = np.bincount(group, minlength=1) * grid.cell**2 >= SMALLEST
    order, group = order[large[group]], group[large[group]]
    part, size = _connected(group, cell[order], grid)
    extent = _extents(part, cell[order], grid)
    large = (size * grid.cell**2 >= SMALLEST) & (size * grid.cell**2 >= NARROWEST * extent)
    number = np.cumsum(large) - 1
    order, part = order[large[part]], number[part[large[part]]]
    if not len(order):
        return []
    once = np.unique(part * grid.size + cell[order], return_index=True)[1]
    order, part = order[once], part[once]
    i, j = np.divmod(cell[order], grid.shape[1])
    around = simplified_all([loops[0] for loops in outlines_of(part, i, j, grid)], 1.5 * grid.cell)
    heights, free = _medians(part, low[order]), _medians(part, headroom[order])
    first = order[np.unique(part, return_index=True)[1]]
    return [
        HoldingSurface(of, outline, height, above, where)
        for of, outline, height, above, where in zip(
            row[first].tolist(), around, heights.tolist(), free.tolist(), room[first].tolist(), strict=True
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
        low, high = grouped_ends(part, count, place)
        longest = np.maximum(longest, (high - low + 1) * grid.cell)
    return longest


def _medians(part: Ints, values: Floats) -> Floats:
    """The median of the values of each part, of parts numbered from 0; inf where most are."""
    order = np.lexsort((values, part))
    count = np.bincount(part)
    first = np.cumsum(count) - count
    ordered = values[order]
    return (ordered[first + (count - 1) // 2] + ordered[first + count // 2]) / 2
