"""Where segments go through triangles, exactly; of many, only those that are near each other are compared."""

from __future__ import annotations

import numpy as np

from .arrays import Bools, Floats, Ints

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
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    found = []
    for mine in _blocks(segments):
        ends = segments[mine]
        first, last = ends.min(axis=1), ends.max(axis=1)
        near = np.flatnonzero(((low <= last.max(axis=0)) & (high >= first.min(axis=0))).all(axis=1))
        meeting = np.ones((len(mine), len(near)), bool)
        for axis in range(3):
            meeting &= first[:, None, axis] <= high[near, axis]
            meeting &= last[:, None, axis] >= low[near, axis]
        one, other = np.nonzero(meeting)
        through = _through(ends[one], triangles[near[other]])
        found.append((mine[one[through]], near[other[through]]))
    if not found:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    return np.concatenate([one for one, _ in found]), np.concatenate([other for _, other in found])


def _blocks(segments: Floats) -> list[Ints]:
    """Numbers of segments that are near each other, a block at a time."""
    cell = np.floor(segments.mean(axis=1) / CELL)
    order = np.lexsort(cell.T)
    return [order[start : start + BLOCK] for start in range(0, len(order), BLOCK)]


def _through(ends: Floats, triangles: Floats) -> Bools:
    """Which segments (K, 2, 3) go through the triangle (K, 3, 3) of the same number."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    start = ((ends[:, 0] - a) * normal).sum(axis=1)
    stop = ((ends[:, 1] - a) * normal).sum(axis=1)
    way = ends[:, 1] - ends[:, 0]
    sides = [(np.cross(q - p, way) * (ends[:, 0] - p)).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))]
    same = (np.stack(sides) > 0).all(axis=0) | (np.stack(sides) < 0).all(axis=0)
    return (start * stop < 0) & same
