"""The symmetric factor S of A = R S, on components: A and R are nine in row-major order, S is six."""

from __future__ import annotations

from .arrays import Components
from .rotations import dot


def stretch_of(r: Components, a: Components) -> Components:
    """S = R^T A, made symmetric: (xx, yy, zz, xy, xz, yz)."""
    r0, r1, r2, a0, a1, a2 = r[0::3], r[1::3], r[2::3], a[0::3], a[1::3], a[2::3]
    xy, xz, yz = dot(r0, a1) + dot(r1, a0), dot(r0, a2) + dot(r2, a0), dot(r1, a2) + dot(r2, a1)
    return (dot(r0, a0), dot(r1, a1), dot(r2, a2), 0.5 * xy, 0.5 * xz, 0.5 * yz)


def twist_of(r: Components, a: Components) -> Components:
    """Axial vector of R^T A - A^T R: zero where R is the polar factor of A."""
    r0, r1, r2, a0, a1, a2 = r[0::3], r[1::3], r[2::3], a[0::3], a[1::3], a[2::3]
    return (dot(r2, a1) - dot(r1, a2), dot(r0, a2) - dot(r2, a0), dot(r1, a0) - dot(r0, a1))


def stretched(r: Components, s: Components) -> Components:
    """A = R S."""
    xx, yy, zz, xy, xz, yz = s
    columns = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    return tuple(dot(r[3 * i : 3 * i + 3], column) for i in range(3) for column in columns)
