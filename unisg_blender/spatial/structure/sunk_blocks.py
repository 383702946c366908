"""Blocks that are sunk in a floor: the floor goes on within them, and nobody stands there."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.column_raster import Crossings
from ...geometry.corner_ends import corner_ends
from ...geometry.grouped_ends import grouped_ends
from .scan import HEADROOM, SAME, FreeSpans, Scan


def in_sunk_blocks(scan: Scan, spans: FreeSpans) -> Bools:
    """Which spans of air (N,) begin on a floor that goes on within something solid, smaller than the floor is.

    Solid is, in a column, what is between a face of an entity that looks down and the next one of it that looks up,
    where its faces in that column look so in turn. What is larger than the floor, as land with a cellar in it, does
    not count.
    """
    begun = np.zeros(len(spans.cell), bool)
    cell, low, high, row = _solid(scan)
    if not len(cell):
        return begun
    sizes = _sizes(scan)
    first, last = np.searchsorted(spans.cell, cell, "left"), np.searchsorted(spans.cell, cell, "right")
    count = last - first
    which = np.repeat(np.arange(len(cell)), count)
    span = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count) + first[which]
    floor = scan.row[spans.triangle[span]]
    within = (low[which] < spans.low[span] - SAME) & (high[which] > spans.low[span] + HEADROOM)
    begun[span[within & (floor != row[which]) & (sizes[row[which]] < sizes[floor])]] = True
    return begun


def _solid(scan: Scan) -> tuple[Ints, Floats, Floats, Ints]:
    """Cells, lower and upper ends and rows of what is solid in columns and as high as people at least."""
    found = scan.all_columns
    found = found.take(scan.building[found.triangle])
    row = scan.row[found.triangle]
    order = np.lexsort((found.height, found.cell, row))
    found, row = Crossings(found.cell[order], found.height[order], found.triangle[order]), row[order]
    up = scan.up[found.triangle]
    starts = np.flatnonzero((np.diff(row, prepend=-1) != 0) | (np.diff(found.cell, prepend=-1) != 0))
    count = np.diff(starts, append=len(row))
    place = np.arange(len(row)) - np.repeat(starts, count)
    in_turn = np.logical_and.reduceat(up == (place % 2 == 1), starts) if len(starts) else np.zeros(0, bool)
    below = np.flatnonzero((place % 2 == 0) & np.repeat(in_turn & (count % 2 == 0), count))
    below = below[found.height[below + 1] - found.height[below] >= HEADROOM]
    return found.cell[below], found.height[below], found.height[below + 1], row[below]


def _sizes(scan: Scan) -> Floats:
    """Square metres of the rectangle around each entity, seen from above."""
    corners = scan.triangles[:, :, :2]
    low, high = grouped_ends(scan.row, int(scan.row.max()) + 1, *corner_ends(corners))
    return np.asarray(np.prod(np.maximum(high - low, 0.0), axis=1))
