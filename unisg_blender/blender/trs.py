"""Affine matrices as Blender spells them: location, XYZ Euler angles and scale."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LINEAR, TRANSLATION = [0, 1, 2, 4, 5, 6, 8, 9, 10], [3, 7, 11]  # entries of a 4x4 matrix, row by row
SHEAR = 1e-6  # cosine of the angle between two axes, above which scale alone cannot say the matrix


@dataclass(frozen=True)
class Channels:
    """``location``, ``euler`` (radians, XYZ order), ``scale``: float64 (N, 3).

    ``sheared`` bool (N,): where these do not say all.
    """

    location: NDArray[np.float64]
    euler: NDArray[np.float64]
    scale: NDArray[np.float64]
    sheared: NDArray[np.bool_]


def split(matrices: NDArray[np.float64]) -> Channels:
    """Location, Euler angles and scale of affine matrices (N, 4, 4); a mirrored one has a negative scale."""
    linear = matrices[:, :3, :3]
    scale = np.linalg.norm(linear, axis=1)
    axes = linear / np.where(scale > 0, scale, 1.0)[:, None, :]
    cosines = np.swapaxes(axes, 1, 2) @ axes
    sheared = np.abs(cosines[:, (0, 0, 1), (1, 2, 2)]).max(axis=1, initial=0) > SHEAR
    rotation = _completed(axes, scale > 0)
    mirrored = np.linalg.det(rotation) < 0
    rotation[mirrored] *= -1
    scale[mirrored] *= -1
    u, _, vt = np.linalg.svd(rotation)  # orthonormal to float64: Euler angles near 90 degrees magnify roundings
    return Channels(matrices[:, :3, 3], euler_xyz(u @ vt), scale, sheared)


def _completed(axes: NDArray[np.float64], full: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Axes with those of zero length replaced, so that all are orthonormal and right-handed where one was missing."""
    axes = axes.copy()
    for row in np.flatnonzero(~full.all(axis=1)):
        known = [axes[row, :, k] for k in range(3) if full[row, k]]
        basis = np.linalg.svd(np.array(known).reshape(-1, 3))[2] if known else np.eye(3)
        spare = iter(basis[len(known) :])
        for k in range(3):
            if not full[row, k]:
                axes[row, :, k] = next(spare)
        if np.linalg.det(axes[row]) < 0:
            axes[row, :, np.flatnonzero(~full[row])[0]] *= -1
    return axes


def euler_xyz(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles (N, 3) in radians of R = Rz Ry Rx, Blender's order "XYZ"; at 90 degrees about Y the last one is 0."""
    across = np.hypot(rotation[:, 0, 0], rotation[:, 1, 0])
    locked = across < 1e-12
    x = np.where(
        locked,
        np.arctan2(-rotation[:, 1, 2], rotation[:, 1, 1]),
        np.arctan2(rotation[:, 2, 1], rotation[:, 2, 2]),
    )
    y = np.arctan2(-rotation[:, 2, 0], across)
    z = np.where(locked, 0.0, np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0]))
    return np.stack([x, y, z], axis=1)


def differ(
    first: NDArray[np.float64], second: NDArray[np.float64], tolerance: float, terms: NDArray[np.float64] | None = None
) -> NDArray[np.bool_]:
    """bool (N,): whether matrices differ by more than ``tolerance``.

    Linear block and translation each by its size, which is that of ``second`` or
    of the ``terms`` that it sums up.
    """
    gap = _by_entry(np.abs(first - second))
    size = _by_entry(np.abs(second) if terms is None else terms)
    linear = size[LINEAR].max(axis=0)
    reach = np.maximum(size[TRANSLATION].max(axis=0), linear)
    alike = (gap[LINEAR].max(axis=0) <= tolerance * linear) & (gap[TRANSLATION].max(axis=0) <= tolerance * reach)
    return np.asarray(~alike)  # what is no number is not alike


def _by_entry(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """(16, N): numpy goes much faster along a long last axis."""
    return np.ascontiguousarray(matrices.reshape(-1, 16).T)
