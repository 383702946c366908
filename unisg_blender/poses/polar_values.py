"""Polar rotations as numbers, for arrays and tensors alike: each row by itself, whatever else is in the batch.

Blocks that are rotations already pass through; well-conditioned ones take Newton's
iteration (Higham 1986); mirrored projections and ranks below 3 take the singular
value decomposition. Gradients are the work of ``polar_tensors``.
"""

from __future__ import annotations

from typing import Any

from .arrays import Components, namespace
from .rotations import cofactors, cross, dot, scale
from .stretch import twist_of

ITERATIONS = 12  # scaled Newton needs 9 for a condition number of 1e16


def rotation_values(a: Components, mirrored: bool) -> Components:
    """Rotations of blocks, nine components of shape (n,); the very same ones where all are rotations already.

    ``mirrored`` as in ``pose_rotation``: -Q where the determinant is negative. Otherwise the nearest rotation.
    """
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
    x, y, z = a[0::3], a[1::3], a[2::3]
    c = cross(x, y)
    errors = (dot(x, x) - 1.0, dot(y, y) - 1.0, dot(x, y), c[0] - z[0], c[1] - z[1], c[2] - z[2])
    return dot(errors, errors) < (40.0 * namespace(a[0]).finfo(a[0].dtype).eps) ** 2


def _newton(a: Any, mirrored: bool) -> tuple[Any, Any]:
    """Scaled Newton iteration on (9, n), and where its result can be trusted.

    A row stops where its last change, squared, is below rounding: that is what is left.
    """
    xp = namespace(a)
    eps = xp.finfo(a.dtype).eps
    x: Components = tuple(a)
    cofactor, determinant = cofactors(x)
    invertible = xp.abs(determinant) > 1e-10  # below, the sign of the determinant may be rounding: rank decides
    moving = invertible
    for _ in range(ITERATIONS):
        balance = xp.sqrt(xp.sqrt(dot(cofactor, cofactor) / dot(x, x)) / xp.abs(determinant))
        keep = xp.where(moving, 0.5 * balance, 1.0)
        turn = xp.where(moving, 0.5 / (balance * determinant), 0.0)
        before, x = x, tuple(keep * p + turn * q for p, q in zip(x, cofactor, strict=True))
        change = tuple(p - q for p, q in zip(x, before, strict=True))
        cofactor, determinant = cofactors(x)
        moving = dot(change, change) > eps
        if not bool(moving.any()):
            break
    x = tuple(0.5 * (p + q / determinant) for p, q in zip(x, cofactor, strict=True))
    sign = xp.where(determinant < 0, -1.0, 1.0)
    r = xp.stack(scale(sign, x) if mirrored else x)
    rest = twist_of(r, a)
    good = invertible & (dot(rest, rest) <= (20.0 * eps) ** 2 * dot(a, a))
    return r, good if mirrored else good & (sign > 0)


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
    identity = xp.zeros_like(source[:1].T * source[:1])
    identity[[0, 1, 2], [0, 1, 2]] = 1.0  # on the device of ``source``
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
