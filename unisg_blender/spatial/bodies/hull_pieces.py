"""Convex pieces of meshes: the hulls of their connected parts, of concave ones several where a decomposer is given."""

from __future__ import annotations

from collections.abc import Callable
from weakref import WeakKeyDictionary

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ...geometry.arrays import Floats, Ints
from ...scene.mesh import Mesh
from ..part_boxes import connected_parts

THIN = 1e-3
"""Metres of thickness below which a part is a sheet: its piece is made so thick."""

HOLLOW = 0.9
"""Share of its hull that a closed part fills at most to be concave."""

MOST_PARTS = 200
"""Connected parts of a mesh from which on it has one hull: grains, leaves, broken topology."""

Decompose = Callable[[Floats, Ints], list[Floats]]
"""Points (V, 3) and triangles (T, 3) of a closed concave part -> points (P, 3) of convex pieces."""

_pieces_of: WeakKeyDictionary[Mesh, dict[Decompose | None, list[Floats]]] = WeakKeyDictionary()


def convex_pieces(mesh: Mesh, decompose: Decompose | None = None) -> list[Floats]:
    """Corners (P, 3) of the convex pieces of a mesh, in its frame, metres; none of a mesh without points.

    ``decompose`` is asked about closed parts that fill less than :data:`HOLLOW` of their hull; without it a bowl is
    as if filled.
    """
    known = _pieces_of.setdefault(mesh, {})
    if decompose not in known:
        known[decompose] = _find(mesh, decompose)
    return known[decompose]


def _find(mesh: Mesh, decompose: Decompose | None) -> list[Floats]:
    if not len(mesh.points) or not np.isfinite(mesh.points).all():
        return []
    places, weld, part = connected_parts(mesh)
    if part.max() >= MOST_PARTS:
        return [_corners(places)]
    triangles = weld[mesh.triangles]
    pieces = []
    for number in range(int(part.max()) + 1):
        own = np.flatnonzero(part == number)
        points = places[own].astype(np.float64)
        faces = np.searchsorted(own, triangles[part[triangles[:, 0]] == number])
        concave = decompose is not None and _fill(points, faces) < HOLLOW
        pieces += decompose(points, faces) if concave and decompose is not None else [_corners(points)]
    return pieces


def _corners(points: Floats) -> Floats:
    """Corners of the hull; of what is flat, those of its box, made :data:`THIN`."""
    points = np.asarray(points, np.float64)
    low, high = points.min(axis=0), points.max(axis=0)
    if len(points) > 3 and (high - low).min() >= THIN:
        try:
            return np.asarray(points[ConvexHull(points).vertices])
        except QhullError:
            pass
    grow = np.maximum(THIN - (high - low), 0) / 2
    ends = np.stack([low - grow, high + grow])
    return np.array([[ends[a, 0], ends[b, 1], ends[c, 2]] for a in (0, 1) for b in (0, 1) for c in (0, 1)])


def _fill(points: Floats, triangles: Ints) -> float:
    """Share of its hull that a closed surface fills; 1 where it is not closed, or flat."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    if not len(edges) or (np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)[1] != 2).any():
        return 1.0
    first, second, third = (points[triangles[:, corner]] for corner in range(3))
    volume = abs(np.einsum("ij,ij->i", first, np.cross(second, third)).sum()) / 6
    try:
        return float(volume / ConvexHull(points).volume)
    except QhullError:
        return 1.0
