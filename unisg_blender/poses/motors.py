"""Rigid motions on components: a unit quaternion with its dual part.

A motor is a pair (r, d): r = (w, x, y, z) the rotation, d = (dw, dx, dy, dz)
the dual part, d = 0.5 (0, t) r. Dual quaternions, PGA motors and CGA motors are
three ways to write this pair down. ``extract`` functions accept a motor times any
number but zero.
"""

from __future__ import annotations

from typing import Any

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


def multiply_motors(a: Components, b: Components) -> Components:
    """First ``b``, then ``a``: (ra rb, ra db + da rb)."""
    left, right = multiply(a[:4], b[4:]), multiply(a[4:], b[:4])
    return (*multiply(a[:4], b[:4]), *(p + q for p, q in zip(left, right, strict=True)))


def inverse_motor(m: Components) -> Components:
    """Inverse of a unit motor: both parts conjugated."""
    return (*conjugate(m[:4]), *conjugate(m[4:]))


def unit_motor(m: Components) -> Components:
    """``nearest_motor`` on eight components."""
    r, d = nearest_motor(m[:4], m[4:])
    return (*r, *d)


def logarithm(m: Components) -> Components:
    """Screw of a unit motor: rotation vector (radians), then the translation that goes with it (metres).

    The angle is that of the motor's own sign: up to pi where w >= 0, beyond it where w < 0.
    With u, p the halves of the two vectors and h = |u|: r = (cos h, sinc(h) u) and
    d = (-sinc(h) u.p, sinc(h) p + c(h) (u.p) u), c(h) = (h cos h - sin h) / h^3.
    """
    xp = namespace(m[0])
    w, v, dw, dv = m[0], m[1:4], m[4], m[5:8]
    squared = dot(v, v)
    still = squared == 0
    length = xp.sqrt(xp.where(still, 1.0, squared))
    k = xp.where(still, 1.0, xp.arctan2(length, w) / length)
    u = scale(k, v)
    _, _, c = _series(dot(u, u))
    along = -k * dw
    p = tuple(k * (dv[i] - c * along * u[i]) for i in range(3))
    return (*scale(2.0, u), *scale(2.0, p))


def exponential(screw: Components) -> Components:
    """Unit motor of a screw, the inverse of ``logarithm``; sign as the angle gives it."""
    u, p = scale(0.5, screw[:3]), scale(0.5, screw[3:6])
    cosine, sinc, c = _series(dot(u, u))
    along = dot(u, p)
    d = tuple(sinc * p[i] + c * along * u[i] for i in range(3))
    return (cosine, *scale(sinc, u), -along * sinc, *d)


def _series(squared: Any) -> tuple[Any, Any, Any]:
    """cos h, sin(h) / h and (h cos h - sin h) / h^3 of h^2, by power series where h is small."""
    xp = namespace(squared)
    small = squared < 1e-4
    h2 = xp.where(small, squared, 0.0)
    h = xp.sqrt(xp.where(small, 1.0, squared))
    sine, cosine = xp.sin(h), xp.cos(h)
    c = xp.where(small, -1.0 / 3.0 + h2 / 30.0 * (1.0 - h2 / 28.0), (h * cosine - sine) / (h * h * h))
    sinc = xp.where(small, 1.0 - h2 / 6.0 * (1.0 - h2 / 20.0), sine / h)
    return xp.where(small, 1.0 - h2 / 2.0 * (1.0 - h2 / 12.0 * (1.0 - h2 / 30.0)), cosine), sinc, c
