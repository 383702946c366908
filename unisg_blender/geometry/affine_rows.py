"""Affine matrices as twelve rows of numbers, (12, K): the upper three rows of each, row by row.

With the components first, every step of the arithmetic runs along contiguous
memory, which is several times as fast as K small matrix products.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..poses.polar import pose_rotation
from .arrays import Bools, Floats

Array = Floats

_ORTHOGONAL = 1e-12


def gather(matrices: Array, rows: NDArray[np.integer]) -> Array:
    """The components (12, K) of some of the matrices (N, 4, 4)."""
    return np.ascontiguousarray(matrices.reshape(-1, 16).take(rows, axis=0).T[:12])


def compose(a: Array, b: Array) -> Array:
    """The components of the products A B."""
    result = np.empty_like(b)
    for i in range(0, 12, 4):
        for j in range(4):
            result[i + j] = a[i] * b[j] + a[i + 1] * b[4 + j] + a[i + 2] * b[8 + j]
        result[i + 3] += a[i + 3]
    return result


def some(columns: Array, places: NDArray[np.integer]) -> Array:
    """Some of the columns (C, K); the very same array where ``places`` are all of them, in order."""
    return columns if len(places) == columns.shape[1] else columns.take(places, 1)


def linear(a: Array) -> Array:
    """The 3x3 parts (3, 3, K) of matrices (12, K), no copy."""
    return a.reshape(3, 4, -1)[:, :3]


def transform(a: Array, points: Array) -> Array:
    """Points (3, K) moved by the matrices (12, K)."""
    moved: Array = np.einsum("ijk,jk->ik", linear(a), points)
    moved += a[3::4]
    return moved


def dot(a: Array, b: Array) -> Array:
    """Scalar products (K,) of vectors (3, K)."""
    return np.einsum("ik,ik->k", a, b)


def column_products(a: Array, b: Array) -> Array:
    """Scalar products (3, K) of the columns of matrices (3, 3, K), each with that of the same number."""
    return np.einsum("ijk,ijk->jk", a, b)


def determinant(a: Array) -> Array:
    """Determinants (K,) of matrices (3, 3, K)."""
    result: Array = a[0, 0] * (a[1, 1] * a[2, 2] - a[1, 2] * a[2, 1])
    result += a[0, 1] * (a[1, 2] * a[2, 0] - a[1, 0] * a[2, 2])
    result += a[0, 2] * (a[1, 0] * a[2, 1] - a[1, 1] * a[2, 0])
    return result


def length(a: Array) -> Array:
    """Lengths (K,) of vectors (3, K)."""
    return np.sqrt(dot(a, a))


def rotation_and_size(a: Array) -> tuple[Array, Array, Bools]:
    """Rotations as columns (9, K), the lengths (3, K) of the matrices' columns, and where these are at right angles.

    The rotation is that of the polar decomposition. Without shear the columns scaled
    to length 1 are just that; only the rest takes the slower way.
    """
    size = np.stack([np.sqrt(a[j] * a[j] + a[4 + j] * a[4 + j] + a[8 + j] * a[8 + j]) for j in range(3)])
    unit = np.empty((9, a.shape[1]))
    with np.errstate(divide="ignore", invalid="ignore"):
        shrink = 1.0 / size
        for j in range(3):
            for i in range(3):
                np.multiply(a[4 * i + j], shrink[j], out=unit[3 * j + i])
        x, y, z = unit[0:3], unit[3:6], unit[6:9]
        skew = np.abs(dot(x, y)) + np.abs(dot(x, z)) + np.abs(dot(y, z))
    straight = skew <= _ORTHOGONAL
    turned = (
        (x[1] * y[2] - x[2] * y[1]) * z[0] + (x[2] * y[0] - x[0] * y[2]) * z[1] + (x[0] * y[1] - x[1] * y[0]) * z[2]
    )
    mirrored = turned < 0
    if mirrored.any():
        unit[:, mirrored] *= -1.0  # -Q, as Blender's decompose does
    slow = ~straight
    if slow.any():
        slow &= np.isfinite(a).all(axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = pose_rotation(tuple(a[4 * i + j, slow] for i in range(3) for j in range(3)))
        unit[:, slow] = [found[3 * i + j] for j in range(3) for i in range(3)]
    return unit, size, straight


def turn_between(u: Array, v: Array) -> Array:
    """Angles (K,) in [0, pi] between rotations given as columns (9, K)."""
    t = [[u[i] * v[j] + u[3 + i] * v[3 + j] + u[6 + i] * v[6 + j] for j in range(3)] for i in range(3)]  # U V^T
    sine = np.sqrt((t[2][1] - t[1][2]) ** 2 + (t[0][2] - t[2][0]) ** 2 + (t[1][0] - t[0][1]) ** 2)
    return np.arctan2(sine, t[0][0] + t[1][1] + t[2][2] - 1.0)
