"""Points and triangulations of the unit sphere with chosen numbers."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from ..errors import UniSGError
from ..geometry.arrays import Floats, Ints
from .simplify import with_faces
from .triangulate import area_vectors


def fibonacci_sphere(count: int) -> Floats:
    """Even points of the unit sphere, float64 (count, 3), on a golden spiral."""
    step = np.arange(count) + 0.5
    z = 1 - 2 * step / count
    angle = np.pi * (3 - np.sqrt(5)) * step
    radius = np.sqrt(1 - z * z)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


@lru_cache(maxsize=256)
def sphere_template(faces: int) -> tuple[Floats, NDArray[np.int32]]:
    """A closed sphere: points (faces / 2 + 2, 3) and counter-clockwise triangles (faces, 3).

    A closed triangle mesh has an even number of faces: an odd number becomes the
    next even one.

    Raises
    ------
    UniSGError
        If ``faces`` is below 4.
    """
    if faces < 4:
        raise UniSGError(f"a closed mesh needs 4 faces or more, not {faces}")
    points = fibonacci_sphere((faces + 1) // 2 + 2)
    triangles = ConvexHull(points).simplices
    inward = np.einsum("tk,tk->t", area_vectors(points, triangles), points[triangles[:, 0]]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return points, triangles.astype(np.int32)


@lru_cache(maxsize=256)
def box_template(faces: int) -> tuple[Floats, Ints]:
    """A closed sphere as :func:`sphere_template`, cut like a box: its edges run along those of the cube around it."""
    if faces < 4:
        raise UniSGError(f"a closed mesh needs 4 faces or more, not {faces}")
    points, triangles = with_faces(*_cube(max(int(np.sqrt(faces / 12)), 1)), faces)
    return points / np.linalg.norm(points, axis=1, keepdims=True), triangles


def _cube(side: int) -> tuple[Floats, Ints]:
    """The cube from -1 to 1 with ``side`` squares along each edge, each of two triangles."""
    low = np.stack(np.meshgrid(np.arange(side), np.arange(side), indexing="ij"), axis=2).reshape(-1, 2)
    flat = (low[:, None] + [(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)]).reshape(-1, 2)
    sides = []
    for axis in range(3):
        top = np.insert(flat, axis, side, axis=1) if axis != 1 else np.insert(flat[:, ::-1], axis, side, axis=1)
        bottom = top.copy()
        bottom[:, axis] = 0
        sides += [top, bottom.reshape(-1, 3, 3)[:, ::-1].reshape(-1, 3)]
    corners, place = np.unique(np.concatenate(sides), axis=0, return_inverse=True)
    return corners * (2 / side) - 1, place.reshape(-1, 3)
