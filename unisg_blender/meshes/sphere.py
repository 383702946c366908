"""Triangulated unit spheres with a chosen number of faces."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from ..errors import UniSGError


def fibonacci_sphere(count: int) -> NDArray[np.float64]:
    """Even points of the unit sphere, float64 (count, 3), on a golden spiral."""
    step = np.arange(count) + 0.5
    z = 1 - 2 * step / count
    angle = np.pi * (3 - np.sqrt(5)) * step
    radius = np.sqrt(1 - z * z)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


@lru_cache(maxsize=8)
def sphere_template(faces: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
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
    a, b, c = points[triangles].swapaxes(0, 1)
    inward = np.einsum("tk,tk->t", np.cross(b - a, c - a), a) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return points, triangles.astype(np.int32)
