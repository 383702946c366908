"""The rotation in a 3x3 block: polar decomposition A = R S with a proper R.

A is nine components in row-major order. Blocks that are rotations already
pass through; well-conditioned ones take Newton's iteration (Higham 1986) on
whole batches; mirrored projections and ranks below 3 take the singular value
decomposition.
"""

from __future__ import annotations

from typing import Any

from .arrays import Components, is_tensor, namespace
from .rotations import cross, dot, scale

ITERATIONS = 12  # scaled Newton needs 9 for a condition number of 1e16


def pose_rotation(a: Components) -> Components:
    """R of A = R S: S is positive where det A >= 0 and negative where det A < 0.

    A mirrored block gives R = -Q and S = -P, as Blender's own decompose does.
    Rank 2 has one such R. Rank 1 leaves a turn about its one direction free, and
    rank 0 leaves all: the smallest rotation that fits is taken.
    """
    return _rotation(a, mirrored=True)


def nearest_rotation(a: Components) -> Components:
    """The proper rotation nearest to A in the Frobenius norm; NaN where A is zero."""
    xp = namespace(a[0])
    empty = dot(a, a) == 0
    return tuple(xp.where(empty, float("nan"), x) for x in _rotation(a, mirrored=False))


def stretch_of(r: Components, a: Components) -> Components:
    """S = R^T A, made symmetric: (xx, yy, zz, xy, xz, yz)."""
    r0, r1, r2 = _columns(r)
    a0, a1, a2 = _columns(a)
    xy, xz, yz = dot(r0, a1) + dot(r1, a0), dot(r0, a2) + dot(r2, a0), dot(r1, a2) + dot(r2, a1)
    return (dot(r0, a0), dot(r1, a1), dot(r2, a2), 0.5 * xy, 0.5 * xz, 0.5 * yz)


def stretched(r: Components, s: Components) -> Components:
    """A = R S."""
    xx, yy, zz, xy, xz, yz = s
    columns = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    return tuple(dot(r[3 * i : 3 * i + 3], column) for i in range(3) for column in columns)


def _columns(a: Components) -> tuple[Components, Components, Components]:
    return a[0::3], a[1::3], a[2::3]


def _rotation(a: Components, mirrored: bool) -> Components:
    if not is_tensor(a[0]):
        return _rotation_values(a, mirrored)
    with namespace(a[0]).no_grad():
        r = _rotation_values(a, mirrored)
        sign = _sign_of_determinant(a) if mirrored else 1.0
    return _newton_step(r, scale(sign, a)) if any(x.requires_grad for x in a) else r


def _rotation_values(a: Components, mirrored: bool) -> Components:
    """Rotations without gradients; the blocks themselves where they are rotations already."""
    xp = namespace(a[0])
    other = ~_is_rotation(a)
    if not bool(other.any()):
        return a
    rest = xp.stack([x[other] for x in a])
    largest = xp.amax(xp.abs(rest), 0)
    rest = rest / xp.where(largest > 0, largest, 1.0)  # squares must neither overflow nor vanish
    r, good = _newton(rest, mirrored)
    if not bool(good.all()):
        r[:, ~good] = _by_svd(rest[:, ~good], mirrored)
    result = xp.stack(tuple(a))
    result[:, other] = r
    return tuple(result)


def _is_rotation(a: Components) -> Any:
    """Whether the columns are orthonormal and right-handed, to a few roundings."""
    x, y, z = _columns(a)
    c = cross(x, y)
    errors = (dot(x, x) - 1.0, dot(y, y) - 1.0, dot(x, y), c[0] - z[0], c[1] - z[1], c[2] - z[2])
    return dot(errors, errors) < (40.0 * namespace(a[0]).finfo(a[0].dtype).eps) ** 2


def _newton(a: Any, mirrored: bool) -> tuple[Any, Any]:
    """Scaled Newton iteration on (9, n), and where its result can be trusted."""
    xp = namespace(a)
    eps = xp.finfo(a.dtype).eps
    x: Components = tuple(a)
    invertible = xp.abs(_determinant(x)) > 1e-10  # below, the sign of the determinant may be rounding: rank decides
    for _ in range(ITERATIONS):
        inverse = _inverse_transpose(x)
        balance = xp.sqrt(xp.sqrt(dot(inverse, inverse) / dot(x, x)))
        before, x = x, tuple(0.5 * (balance * p + q / balance) for p, q in zip(x, inverse, strict=True))
        change = tuple(p - q for p, q in zip(x, before, strict=True))
        if not bool((dot(change, change) > eps).any()):  # what is left is the square of this, below rounding
            break
    inverse = _inverse_transpose(x)
    x = tuple(0.5 * (p + q) for p, q in zip(x, inverse, strict=True))
    sign = _sign_of_determinant(x)
    if mirrored:
        x = scale(sign, x)
    r = xp.stack(x)
    twist = _twist(x, a)
    good = invertible & (dot(twist, twist) <= (20.0 * eps) ** 2 * dot(a, a))
    return r, good if mirrored else good & (sign > 0)


def _inverse_transpose(x: Components) -> Components:
    u, v, w = x[0:3], x[3:6], x[6:9]
    first = cross(v, w)
    inverse = 1.0 / dot(u, first)
    return tuple(inverse * c for c in (*first, *cross(w, u), *cross(u, v)))


def _determinant(a: Components) -> Any:
    return dot(a[0:3], cross(a[3:6], a[6:9]))


def _sign_of_determinant(a: Components) -> Any:
    return namespace(a[0]).where(_determinant(a) < 0, -1.0, 1.0)


def _by_svd(a: Any, mirrored: bool) -> Any:
    """Rotations (9, n) of any blocks (9, n) whose largest entry is about 1."""
    xp = namespace(a)
    u, s, vt = xp.linalg.svd(a.T.reshape(-1, 3, 3))
    v = xp.swapaxes(vt, 1, 2)
    handed = xp.sign(xp.linalg.det(u) * xp.linalg.det(v))
    rank = (s > 16.0 * xp.finfo(s.dtype).eps * s[:, :1]).sum(1)
    flip = (handed < 0) & (rank == 3) if mirrored else xp.zeros_like(handed) > 0
    u[:, :, 2] *= xp.where(flip, 1.0, handed)[:, None]
    r = xp.where(flip, -1.0, 1.0)[:, None, None] * (u @ vt)
    thin = rank < 2
    if bool(thin.any()):
        r[thin] = _smallest_rotation(v[thin][:, :, 0], u[thin][:, :, 0], rank[thin])
    return r.reshape(-1, 9).T


def _smallest_rotation(source: Any, target: Any, rank: Any) -> Any:
    """The smallest rotation (n, 3, 3) from unit vector ``source`` to ``target``; identity for rank 0.

    Opposite vectors turn about the coordinate axis that is most across them, made
    perpendicular.
    """
    xp = namespace(source)
    identity = xp.eye(3, dtype=source.dtype)
    middle = source + target
    length = xp.sqrt((middle * middle).sum(1))
    opposite = length < 1e-7
    axis = identity[xp.argmin(xp.abs(source), 1)]
    axis = axis - (axis * source).sum(1)[:, None] * source
    middle = xp.where(opposite[:, None], axis, middle)
    middle = middle / xp.sqrt((middle * middle).sum(1))[:, None]
    half_turn = 2.0 * middle[:, :, None] * middle[:, None, :] - identity
    reflected = identity - 2.0 * source[:, :, None] * source[:, None, :]
    turn = xp.where(opposite[:, None, None], half_turn, half_turn @ -reflected)
    return xp.where((rank > 0)[:, None, None], turn, identity)


def _twist(r: Components, a: Components) -> Components:
    """Axial vector of R^T A - A^T R: zero where R is the polar factor of A."""
    r0, r1, r2 = _columns(r)
    a0, a1, a2 = _columns(a)
    return (dot(r2, a1) - dot(r1, a2), dot(r0, a2) - dot(r2, a0), dot(r1, a0) - dot(r0, a1))


def _newton_step(r: Components, a: Components) -> Components:
    """R again, now with the gradient of the polar factor of A.

    dR = R hat(w) with (tr(S) 1 - S) w = axial(R^T dA - dA^T R). The step itself is zero
    to rounding, so values stay; where the factor has no derivative the gradient is zero.
    """
    xp = namespace(a[0])
    xx, yy, zz, xy, xz, yz = (x.detach() for x in stretch_of(r, a))
    m = (yy + zz, -xy, -xz, -xy, xx + zz, -yz, -xz, -yz, xx + yy)
    u, v, w = m[0:3], m[3:6], m[6:9]
    first = cross(v, w)
    determinant = dot(u, first)
    size = xp.sqrt(dot(m, m))
    flat = xp.abs(determinant) <= 16.0 * xp.finfo(size.dtype).eps * size**3
    factor = xp.where(flat, 0.0, 1.0 / xp.where(flat, 1.0, determinant))
    twist = _twist(r, a)
    turn = [
        factor * (p * twist[0] + q * twist[1] + s * twist[2])
        for p, q, s in zip(first, cross(w, u), cross(u, v), strict=True)
    ]
    moved = [cross(turn, row) for row in (r[0:3], r[3:6], r[6:9])]
    return tuple(x - y for x, y in zip(r, (c for row in moved for c in row), strict=True))
