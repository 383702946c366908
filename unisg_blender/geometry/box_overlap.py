"""Do oriented boxes overlap, and how deep; which pairs of many can."""

from __future__ import annotations

import numpy as np

from .arrays import Floats, Ints
from .boxes import Boxes, world_bounds

_SWEEP_UP_TO = 4000


def penetration(first: Boxes, second: Boxes) -> Floats:
    """How deep box k of ``first`` reaches into box k of ``second``, float64 (K,), metres.

    Separating-axis test over 3 + 3 face normals and 9 products of edges (Gottschalk,
    Lin and Manocha, "OBBTree", 1996). Positive: the shortest push that parts them.
    Negative: they are apart by at least that much (exactly that much where a face
    of one looks at the other). Zero: they touch.
    """
    offset = second.center - first.center
    turn = np.swapaxes(first.axes, 1, 2) @ second.axes  # the second's axes in the first's frame
    size = np.abs(turn)
    seen = np.einsum("kij,ki->kj", first.axes, offset)
    faces_first = first.half + np.einsum("kij,kj->ki", size, second.half) - np.abs(seen)
    faces_second = second.half + np.einsum("kij,ki->kj", size, first.half)
    faces_second = faces_second - np.abs(np.einsum("kij,ki->kj", second.axes, offset))
    depth = np.minimum(faces_first.min(axis=1), faces_second.min(axis=1))
    one, two = [1, 2, 0], [2, 0, 1]
    reach = first.half[:, one, None] * size[:, two] + first.half[:, two, None] * size[:, one]
    reach = reach + second.half[:, None, one] * size[:, :, two] + second.half[:, None, two] * size[:, :, one]
    gap = reach - np.abs(seen[:, two, None] * turn[:, one] - seen[:, one, None] * turn[:, two])
    length = np.sqrt(np.maximum(1 - turn**2, 0))
    edges = np.divide(gap, length, out=np.full_like(gap, np.inf), where=length > 1e-6)  # parallel: the faces decide
    return np.minimum(depth, edges.min(axis=(1, 2)))


def nearby_pairs(boxes: Boxes, margin: float = 0.0) -> Ints:
    """Pairs (K, 2) of boxes whose axis-aligned boxes come within ``margin`` metres; first < second, sorted.

    Up to some thousand boxes are swept along one axis. More are O(N log N) for objects spread
    out in space: every box is entered in a grid whose cells are as large as itself, and
    looks among the boxes of its own and of larger size only into the 27 cells around it.
    """
    low, high = world_bounds(boxes)
    low, high = low - margin / 2, high + margin / 2
    first, second = _swept_pairs(low, high) if len(low) <= _SWEEP_UP_TO else _grid_pairs(low, high)
    hit = ((low[first] <= high[second]) & (low[second] <= high[first])).all(axis=1)
    pairs = np.stack([first[hit], second[hit]], axis=1)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def _swept_pairs(low: Floats, high: Floats) -> tuple[Ints, Ints]:
    """Candidates that overlap along the axis on which the boxes are spread out most, each once."""
    axis = int((low.max(axis=0, initial=-np.inf) - low.min(axis=0, initial=np.inf)).argmax())
    order = np.argsort(low[:, axis], kind="stable")
    after = np.arange(1, len(order) + 1)
    repeat = np.maximum(np.searchsorted(low[order, axis], high[order, axis], "right") - after, 0)
    step = np.arange(repeat.sum()) - np.repeat(np.cumsum(repeat) - repeat, repeat)
    one, two = np.repeat(order, repeat), order[np.repeat(after, repeat) + step]
    return np.minimum(one, two), np.maximum(one, two)


def _grid_pairs(low: Floats, high: Floats) -> tuple[Ints, Ints]:
    """Candidates out of a grid per size class; every pair that overlaps is among them, each once."""
    middle, longest = (low + high) / 2, np.maximum((high - low).max(axis=1), 1e-3)
    level = np.ceil(np.log2(longest)).astype(np.int64)
    around = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    found = []
    for cell_level in np.unique(level):
        cell = 2.0**cell_level
        residents, visitors = np.flatnonzero(level == cell_level), np.flatnonzero(level <= cell_level)
        keys = _cell_keys(middle, residents, cell)
        order = np.argsort(keys, kind="stable")
        for step in around:
            homes = _cell_keys(middle + step * cell, visitors, cell)
            start = np.searchsorted(keys, homes, "left", sorter=order)
            stop = np.searchsorted(keys, homes, "right", sorter=order)
            repeat = stop - start
            inside = np.arange(repeat.sum()) - np.repeat(np.cumsum(repeat) - repeat, repeat)
            found.append((np.repeat(visitors, repeat), residents[order[np.repeat(start, repeat) + inside]]))
    visitor = np.concatenate([pair[0] for pair in found])
    resident = np.concatenate([pair[1] for pair in found])
    once = (level[visitor] < level[resident]) | (visitor < resident)
    visitor, resident = visitor[once], resident[once]
    return np.minimum(visitor, resident), np.maximum(visitor, resident)


def _cell_keys(points: Floats, rows: Ints, cell: float) -> Ints:
    """One number per cell; cells far apart may share one, which costs a test and never loses a pair."""
    x, y, z = (np.floor(points[rows] / cell).astype(np.int64) & 0x1FFFFF).T
    return x << 42 | y << 21 | z
