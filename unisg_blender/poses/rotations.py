"""Rotations on components: 3x3 matrix, quaternion, axis and angle, two columns.

A rotation matrix is nine components in row-major order; a quaternion is
Hamilton, scalar first: (w, x, y, z). See ``arrays`` for components.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .arrays import Components, is_tensor, namespace


def dot(a: Components, b: Components) -> Any:
    """Sum of the products of two equally long component lists."""
    total = a[0] * b[0]
    for x, y in zip(a[1:], b[1:], strict=True):
        total = total + x * y
    return total


def cross(a: Components, b: Components) -> Components:
    """Cross product of two 3-vectors."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def scale(factor: Any, a: Components) -> Components:
    """Every component times ``factor``."""
    return tuple(factor * x for x in a)


def cofactors(a: Components) -> tuple[Components, Any]:
    """Cofactors of a 3x3 block and its determinant; their quotient is the inverse, transposed."""
    u, v, w = a[0:3], a[3:6], a[6:9]
    first = cross(v, w)
    return (*first, *cross(w, u), *cross(u, v)), dot(u, first)


def canonical_sign(q: Components) -> Any:
    """+1 or -1 that makes w > 0, or the first non-zero of x, y, z positive where w is 0."""
    w, x, y, z = q
    flip = (w < 0) | ((w == 0) & ((x < 0) | ((x == 0) & ((y < 0) | ((y == 0) & (z < 0))))))
    return namespace(w).where(flip, -1.0, 1.0)


def unit_quaternion(q: Components) -> Components:
    """The unit quaternion of canonical sign on the line of ``q``."""
    factor = canonical_sign(q) / namespace(q[0]).sqrt(dot(q, q))
    return scale(factor, q)


def quaternion_from_rotation(r: Components) -> Components:
    """Unit quaternion of canonical sign from a proper rotation matrix.

    The longest row of 4 q q^T decides. Arrays take the first row, 4 w q, wherever it is
    long enough (up to 168 degrees), which is three times as fast.
    """
    if is_tensor(r[0]):
        return _quaternion_by_longest_row(r)
    row = (1.0 + (r[0] + r[4] + r[8]), r[7] - r[5], r[2] - r[6], r[3] - r[1])
    q = scale(1.0 / np.sqrt(dot(row, row)), row)
    short = np.flatnonzero(row[0] < 0.04)
    if len(short):
        for channel, exact in zip(q, _quaternion_by_longest_row(tuple(x[short] for x in r)), strict=True):
            channel[short] = exact
    return q


def _quaternion_by_longest_row(r: Components) -> Components:
    """Any rotation matrix: the rows are 4 w q, 4 x q, 4 y q and 4 z q (Shepperd 1978)."""
    xp = namespace(r[0])
    a, b, c = r[7] - r[5], r[2] - r[6], r[3] - r[1]
    d, e, f = r[3] + r[1], r[2] + r[6], r[7] + r[5]
    plus, minus = 1.0 + r[0], 1.0 - r[0]
    sum_, difference = r[4] + r[8], r[4] - r[8]
    ww, xx, yy, zz = plus + sum_, plus - sum_, minus + difference, minus - difference
    first, second, last = ww >= xx, yy >= zz, xp.maximum(ww, xx) >= xp.maximum(yy, zz)
    wx = (xp.where(first, ww, a), xp.where(first, a, xx), xp.where(first, b, d), xp.where(first, c, e))
    yz = (xp.where(second, b, c), xp.where(second, d, e), xp.where(second, yy, f), xp.where(second, f, zz))
    return unit_quaternion(tuple(xp.where(last, i, j) for i, j in zip(wx, yz, strict=True)))


def rotation_from_quaternion(q: Components) -> Components:
    """Rotation matrix of a quaternion of any norm but zero."""
    w, x, y, z = q
    s = 2.0 / dot(q, q)
    sx, sy, sz = s * x, s * y, s * z
    wx, wy, wz = w * sx, w * sy, w * sz
    xx, xy, xz, yy, yz, zz = x * sx, x * sy, x * sz, y * sy, y * sz, z * sz
    return (1.0 - (yy + zz), xy - wz, xz + wy, xy + wz, 1.0 - (xx + zz), yz - wx, xz - wy, yz + wx, 1.0 - (xx + yy))


def axis_angle_from_quaternion(q: Components) -> Components:
    """(angle, ax, ay, az) of a quaternion of canonical sign; angle in [0, pi], axis (1, 0, 0) at angle 0."""
    xp = namespace(q[0])
    w, x, y, z = q
    squared = dot(q[1:], q[1:])
    still = squared == 0
    length = xp.sqrt(xp.where(still, 1.0, squared))  # a safe root: its gradient must not be NaN at angle 0
    angle = xp.where(still, 0.0, 2.0 * xp.arctan2(length, w))
    return (angle, xp.where(still, 1.0, x / length), xp.where(still, 0.0, y / length), xp.where(still, 0.0, z / length))


def quaternion_from_axis_angle(angle: Any, axis: Components) -> Components:
    """Unit quaternion, sign as it comes, from any angle and an axis of any length but zero."""
    xp = namespace(angle)
    s = xp.sin(0.5 * angle) / xp.sqrt(dot(axis, axis))
    return (xp.cos(0.5 * angle), *scale(s, axis))


def rotation_from_columns(a: Components, b: Components) -> Components:
    """Gram-Schmidt on two columns, the third by the cross product (Zhou et al. 2019).

    Columns that are parallel within rounding give NaN: they hold no rotation.
    """
    xp = namespace(a[0])
    a = scale(1.0 / xp.sqrt(dot(a, a)), a)
    length = dot(b, b)
    along = dot(a, b)
    rest = tuple(y - along * x for x, y in zip(a, b, strict=True))
    rest = tuple(
        y - dot(a, rest) * x for x, y in zip(a, rest, strict=True)
    )  # twice is enough, for nearly parallel ones
    left = dot(rest, rest)
    eps = xp.finfo(left.dtype).eps
    left = xp.where(left > (4.0 * eps) ** 2 * length, left, float("nan"))
    b = scale(1.0 / xp.sqrt(left), rest)
    c = cross(a, b)
    return (a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2])
