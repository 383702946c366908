"""Where segments go through triangles, exactly; of many, only those that are near each other are compared."""

from __future__ import annotations

import numpy as np

from .arrays import Floats, Ints
from .corner_ends import corner_ends, meeting_ends

BLOCK = 128
"""Segments that are compared with the triangles around them at a time."""

CELL = 0.2
"""Metres of the cells by which segments are put into blocks."""


def edges_of(triangles: Floats) -> Floats:
    """The sides (3M, 2, 3) of triangles (M, 3, 3)."""
    return np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2, 3)


def crossings(segments: Floats, triangles: Floats) -> tuple[Ints, Ints]:
    """Numbers of the segments (S, 2, 3) and of the triangles (M, 3, 3) that they go through, (K,) each.

    By the signs of volumes: where a segment only touches a triangle's border or plane it does not go through.
    """
    if not len(triangles) or not len(segments):
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    low, high = corner_ends(triangles)
    ends_low, ends_high = corner_ends(segments)
    close = meeting_ends(ends_low, ends_high, low.min(axis=0), high.max(axis=0))
    found = [(np.zeros(0, np.int64), np.zeros(0, np.int64))]
    for mine in _blocks(segments, np.flatnonzero(close)):
        first, last = ends_low[mine], ends_high[mine]
        near = np.flatnonzero(meeting_ends(low, high, first.min(axis=0), last.max(axis=0)))
        meeting = np.ones((len(mine), len(near)), bool)
        for axis in range(3):
            meeting &= first[:, None, axis] <= high[near, axis]
            meeting &= last[:, None, axis] >= low[near, axis]
        one, other = np.nonzero(meeting)
        through = _through(segments[mine[one]], triangles[near[other]])
        found.append((mine[one[through]], near[other[through]]))
    return np.concatenate([one for one, _ in found]), np.concatenate([other for _, other in found])


def _blocks(segments: Floats, numbers: Ints) -> list[Ints]:
    """Those numbers of segments, that are near each other, a block at a time."""
    cell = np.floor(segments[numbers].mean(axis=1) / CELL)
    order = numbers[np.lexsort(cell.T)]
    return [order[start : start + BLOCK] for start in range(0, len(order), BLOCK)]


def _through(ends: Floats, triangles: Floats) -> Ints:
    """Which segments (K, 2, 3) go through the triangle (K, 3, 3) of the same number."""
    a = triangles[:, 0]
    normal = _cross(triangles[:, 1] - a, triangles[:, 2] - a)
    crossed = np.flatnonzero(_dot(ends[:, 0] - a, normal) * _dot(ends[:, 1] - a, normal) < 0)
    start, way = ends[crossed, 0], ends[crossed, 1] - ends[crossed, 0]
    corners = triangles[crossed].transpose(1, 0, 2)
    sides = np.stack([_dot(_cross(q - p, way), start - p) for p, q in zip(corners, corners[[1, 2, 0]], strict=True)])
    return crossed[(sides > 0).all(axis=0) | (sides < 0).all(axis=0)]


def _dot(one: Floats, two: Floats) -> Floats:
    product = one * two
    return np.asarray(product[:, 0] + product[:, 1] + product[:, 2])


def _cross(one: Floats, two: Floats) -> Floats:
    """As numpy's, which takes five times as long on few vectors."""
    (a, b, c), (x, y, z) = one.T, two.T
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=1)
