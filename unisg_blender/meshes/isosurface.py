"""The level set of a function on a grid as a closed triangle mesh, by marching tetrahedra.

Why not scikit-image: its marching cubes weigh 30 MB in the extension for this one function.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from ..geometry.arrays import Bools, Floats, Ints

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]])
TINY = 1e-9


def isosurface(values: NDArray[np.floating]) -> tuple[Floats, Ints]:
    """Where a function on a grid is zero.

    Every cell is cut into the same six tetrahedra (Freudenthal), so that cells
    agree on their common faces: the mesh is manifold, has no gaps and, as the
    grid's border is taken to be positive, is closed.

    Parameters
    ----------
    values
        (X, Y, Z), negative inside.

    Returns
    -------
    points
        float64 (V, 3) in units of the grid's cells.
    triangles
        int64 (T, 3), counter-clockwise from outside.
    """
    level = _closed(values)
    inside = (level < 0).ravel()
    cells = _crossed_cells(level < 0)
    strides = np.array([level.shape[1] * level.shape[2], level.shape[2], 1])
    corner = cells[:, None] + CORNERS @ strides
    soup = [_tetrahedron(corner[:, list(tet)], inside, table) for tet, table in _tables()]
    edges = np.concatenate(soup).reshape(-1, 2) if soup else np.zeros((0, 2), np.int64)
    edges.sort(axis=1)
    keys, triangles = np.unique(edges[:, 0] * level.size + edges[:, 1], return_inverse=True)
    ends = np.stack([keys // level.size, keys % level.size], axis=1)
    low, high = level.ravel()[ends].T
    share = (low / (low - high))[:, None]
    first, second = (np.stack(np.unravel_index(ends[:, k], level.shape), axis=1) for k in range(2))
    return first + share * (second - first), triangles.reshape(-1, 3)


def _closed(values: NDArray[np.floating]) -> Floats:
    """The function, positive on the border and never so near to zero that points of the surface coincide."""
    level = np.array(values, np.float64)
    scale = max(float(np.abs(level).max(initial=0)), 1e-300)
    level /= scale
    for axis in range(3):
        border = np.moveaxis(level, axis, 0)
        border[[0, -1]] = np.maximum(border[[0, -1]], 0.1)
    near = np.abs(level) < TINY
    level[near] = TINY
    return level


def _crossed_cells(inside: Bools) -> Ints:
    """Flat numbers of the lowest corners of the cells with corners on both sides."""
    shape = tuple(side - 1 for side in inside.shape)
    count = np.zeros(shape, np.int8)
    for x, y, z in CORNERS:
        count += inside[x : x + shape[0], y : y + shape[1], z : z + shape[2]]
    return np.ravel_multi_index(np.nonzero((count > 0) & (count < 8)), inside.shape)


def _tetrahedron(corner: Ints, inside: Bools, table: list[list]) -> Ints:
    """Triangles (T, 3, 2) of one tetrahedron per row of ``corner`` (K, 4): each point an edge of the grid."""
    case = inside[corner] @ np.array([1, 2, 4, 8])
    found = [corner[case == mask][:, triangle] for mask in range(1, 15) for triangle in table[mask]]
    return np.concatenate(found)


@lru_cache(maxsize=1)
def _tables() -> list[tuple[tuple[int, ...], list[list]]]:
    """The six tetrahedra of a cell (corner numbers) and, for each set of inner corners, triangles of edges."""
    tets: list[tuple[tuple[int, ...], list[list]]] = []
    for order in permutations((1, 2, 4)):
        tet = (0, order[0], order[0] + order[1], 7)
        tets.append((tet, [_triangles(CORNERS[list(tet)], mask) for mask in range(16)]))
    return tets


def _triangles(tet: Ints, mask: int) -> list[Ints]:
    """Triangles (3, 2) of edges between the inner corners (bits of ``mask``) and the outer ones, facing outwards."""
    inner = [k for k in range(4) if mask >> k & 1]
    outer = [k for k in range(4) if not mask >> k & 1]
    if len(inner) == 2:
        (a, b), (c, d) = inner, outer
        faces = [[(a, c), (a, d), (b, d)], [(a, c), (b, d), (b, c)]]
    else:
        faces = [[(i, o) for i in inner for o in outer]] if inner and outer else []
    outwards = tet[outer].mean(axis=0) - tet[inner].mean(axis=0) if faces else np.zeros(3)
    turned = []
    for face in faces:
        p, q, r = (tet[list(edge)].mean(axis=0) for edge in face)
        turned.append(np.array(face if np.cross(q - p, r - p) @ outwards > 0 else face[::-1]))
    return turned
