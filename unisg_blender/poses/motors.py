"""Rigid motions on components: a unit quaternion with its dual part.

A motor is a pair (r, d): r = (w, x, y, z) the rotation, d = (dw, dx, dy, dz)
the dual part, d = 0.5 (0, t) r. Dual quaternions, PGA motors and CGA motors are
three ways to write this pair down. ``extract`` functions accept a motor times any
number but zero.
"""

from __future__ import annotations

from .arrays import Components, namespace
from .rotations import canonical_sign, cross, dot, scale


def dual_part(q: Components, t: Components) -> Components:
    """d = 0.5 (0, t) q."""
    w, v = q[0], q[1:]
    h = scale(0.5, t)
    c = cross(h, v)
    return (0.0 - dot(h, v), w * h[0] + c[0], w * h[1] + c[1], w * h[2] + c[2])


def extract_translation(r: Components, d: Components) -> Components:
    """t = 2 (w dv - dw v - dv x v) / |r|^2, for a motor times any number but zero.

    A part of d along r, which no motor has, drops out by itself.
    """
    w, v, dw, dv = r[0], r[1:], d[0], d[1:]
    s = 2.0 / dot(r, r)
    c = cross(dv, v)
    return tuple(s * (w * dv[i] - dw * v[i] - c[i]) for i in range(3))


def nearest_motor(r: Components, d: Components) -> tuple[Components, Components]:
    """Unit motor of canonical sign: divide by |r|, then remove from d its part along r."""
    factor = canonical_sign(r) / namespace(r[0]).sqrt(dot(r, r))
    r, d = scale(factor, r), scale(factor, d)
    along = dot(r, d)
    return r, tuple(y - along * x for x, y in zip(r, d, strict=True))


def multiply(a: Components, b: Components) -> Components:
    """Hamilton product of two quaternions."""
    w, x, y, z = a
    v, i, j, k = b
    return (
        w * v - x * i - y * j - z * k,
        w * i + x * v + y * k - z * j,
        w * j - x * k + y * v + z * i,
        w * k + x * j - y * i + z * v,
    )


def conjugate(q: Components) -> Components:
    """(w, -x, -y, -z)."""
    return (q[0], -q[1], -q[2], -q[3])
