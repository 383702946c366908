"""The rotation in a 3x3 block: polar decomposition A = R S with a proper R. A is nine components, row-major."""

from __future__ import annotations

from .arrays import Components, is_tensor, namespace
from .polar_values import rotation_values
from .rotations import dot


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


def _rotation(a: Components, mirrored: bool) -> Components:
    if not is_tensor(a[0]):
        return rotation_values(a, mirrored)
    from .polar_tensors import differentiable_rotation  # opens torch

    return differentiable_rotation(a, mirrored)
