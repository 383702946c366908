"""The exact distance between oriented boxes that are apart."""

from __future__ import annotations

import numpy as np

from .arrays import Floats
from .boxes import Boxes, corners

_EDGES = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b).bit_count() == 1])
_AT_ONCE = 500  # pairs of boxes: 144 pairs of edges each


def separation(first: Boxes, second: Boxes) -> Floats:
    """Distance (K,) in metres between box k of ``first`` and box k of ``second``; of no use where they overlap.

    Between convex bodies the shortest way joins a corner of one to the other box, or
    the insides of two edges.
    """
    result = np.minimum(_corner_distance(first, second), _corner_distance(second, first))
    for begin in range(0, len(result), _AT_ONCE):
        part = np.arange(begin, min(begin + _AT_ONCE, len(result)))
        result[part] = np.minimum(result[part], _edge_distance(first.take(part), second.take(part)))
    return result


def _corner_distance(first: Boxes, second: Boxes) -> Floats:
    seen = np.einsum("kij,kci->kcj", second.axes, corners(first) - second.center[:, None])
    outside = np.maximum(np.abs(seen) - second.half[:, None], 0)
    return _length(outside).min(axis=1)


def _edge_distance(first: Boxes, second: Boxes) -> Floats:
    """Shortest way between edges where both ends lie inside them; infinite where there is none."""
    p, q = corners(first), corners(second)
    start, along = p[:, _EDGES[:, 0], None], (p[:, _EDGES[:, 1]] - p[:, _EDGES[:, 0]])[:, :, None]
    other, across = q[:, None, _EDGES[:, 0]], (q[:, _EDGES[:, 1]] - q[:, _EDGES[:, 0]])[:, None]
    offset = other - start
    aa, bb, ab = _dot(along, along), _dot(across, across), _dot(along, across)
    ao, bo = _dot(along, offset), _dot(across, offset)
    with np.errstate(divide="ignore", invalid="ignore"):
        determinant = aa * bb - ab * ab
        s, t = (ao * bb - bo * ab) / determinant, (ao * ab - bo * aa) / determinant
        inside = (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1) & (determinant > 1e-12 * aa * bb)
        gap = offset + t[..., None] * across - s[..., None] * along
    return np.where(inside, _length(gap), np.inf).min(axis=(1, 2))


def _dot(a: Floats, b: Floats) -> Floats:
    return np.einsum("...i,...i->...", a, b)


def _length(a: Floats) -> Floats:
    return np.sqrt(_dot(a, a))
