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

MOST_FACES = 5000
"""Triangles of a mesh from which on it is not taken apart into them."""

CONVEX, BEHIND, LEAST_AREA = 0.99, 0.01, 1e-8
"""Share of its hull that a convex part fills; metres that a face is thick; square metres, twice, of a face at least."""

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


def firm_pieces(mesh: Mesh, most: int = MOST_FACES) -> list[Floats]:
    """Corners (P, 3) of convex pieces over the surface of a mesh that does not move: nothing hollow is filled.

    Convex parts are their hulls; of any other part each triangle is a prism :data:`BEHIND` its face. A mesh of more
    than ``most`` triangles has the hulls of its parts.
    """
    triangles = mesh.triangles
    if len(triangles) > most or not len(mesh.points) or not np.isfinite(mesh.points).all():
        return convex_pieces(mesh)
    places, weld, part = connected_parts(mesh)
    faces = weld[triangles]
    pieces = []
    for number in range(int(part.max()) + 1):
        own = np.flatnonzero(part == number)
        mine = faces[part[faces[:, 0]] == number]
        if _fill(places[own], np.searchsorted(own, mine), open_fill=0.0) > CONVEX:
            pieces.append(_corners(places[own]))
        else:
            pieces += [prism for corners in places[mine] if (prism := face_prism(corners)) is not None]
    return pieces


def face_prism(triangle: Floats, depth: float = BEHIND) -> Floats | None:
    """A triangle (3, 3) with its thickness behind its face, (6, 3); None where it has no area."""
    normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
    length = float(np.linalg.norm(normal))
    return None if length < LEAST_AREA else np.concatenate([triangle, triangle - depth * normal / length])


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


def _fill(points: Floats, triangles: Ints, open_fill: float = 1.0) -> float:
    """Share of its hull that a closed surface fills; ``open_fill`` where it is not closed, or flat."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    if not len(edges) or (np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)[1] != 2).any():
        return open_fill
    first, second, third = (points[triangles[:, corner]] for corner in range(3))
    volume = abs(np.einsum("ij,ij->i", first, np.cross(second, third)).sum()) / 6
    try:
        return float(volume / ConvexHull(points).volume)
    except QhullError:
        return open_fill
