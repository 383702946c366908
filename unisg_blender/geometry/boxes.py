"""Oriented boxes as arrays: corners, reach, what they cover."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from .arrays import Bools, Floats, Ints
from .planar import rotate


@dataclass(frozen=True, eq=False)
class Boxes:
    """Oriented boxes in the world, one per row.

    ``center`` (N, 3) metres; ``axes`` (N, 3, 3) orthonormal, axis k is the column
    ``axes[:, :, k]``; ``half`` (N, 3) half extents along them in metres; ``solid``
    bool (N,): False for rows without geometry (their box is a point).
    """

    center: Floats
    axes: Floats
    half: Floats
    solid: Bools

    def take(self, rows: NDArray[np.integer]) -> Boxes:
        """The boxes of some rows."""
        return Boxes(self.center[rows], self.axes[rows], self.half[rows], self.solid[rows])


def orthonormal_axes(linear: Floats) -> Floats:
    """Right-handed orthonormal axes (N, 3, 3) along the columns of ``linear``; world axes where a column vanishes."""
    axes, triangular = np.linalg.qr(linear)
    diagonal = np.einsum("nii->ni", triangular)
    axes = axes * np.where(diagonal < 0, -1.0, 1.0)[:, None, :]
    flipped = np.linalg.det(axes) < 0
    axes[flipped, :, 2] *= -1
    scale = np.abs(diagonal)
    broken = scale.min(axis=1, initial=np.inf) <= 1e-12 * np.maximum(scale.max(axis=1, initial=0), 1e-300)
    axes[broken] = np.eye(3)
    return axes


def boxes_around(bounds: Floats, matrices: Floats, axes: Floats) -> Boxes:
    """Boxes along ``axes`` (N, 3, 3) around the boxes ``bounds`` (N, 2, 3) that affine matrices (N, 4, 4) move."""
    linear, middle, half = matrices[:, :3, :3], bounds.mean(axis=1), (bounds[:, 1] - bounds[:, 0]) / 2
    spread = np.abs(np.swapaxes(axes, 1, 2) @ linear)  # extent along our axes of a unit step along each local axis
    center = matrices[:, :3, 3] + np.einsum("nij,nj->ni", linear, middle)
    return Boxes(center, axes, np.einsum("nij,nj->ni", spread, half), np.ones(len(axes), bool))


SIGNS = np.array(list(product((-1.0, 1.0), repeat=3)))
"""The eight corners of a cube from -1 to 1, the last axis fastest."""


def corners(boxes: Boxes) -> Floats:
    """The corners of boxes, (N, 8, 3), in the order of :data:`SIGNS`."""
    return boxes.center[:, None] + (SIGNS * boxes.half[:, None]) @ np.swapaxes(boxes.axes, 1, 2)


def reach(boxes: Boxes) -> Floats:
    """How far boxes reach from their middles along the world's axes, (N, 3)."""
    return (np.abs(boxes.axes) @ boxes.half[:, :, None])[:, :, 0]


def world_bounds(boxes: Boxes) -> tuple[Floats, Floats]:
    """Lowest and highest corners (N, 3) of boxes in the world."""
    far = reach(boxes)
    return boxes.center - far, boxes.center + far


def upright_boxes(parts: Boxes, owner: Ints, yaw: Floats, origin: Floats) -> tuple[Floats, Floats]:
    """Centres and half extents (K, 3) of boxes turned by ``yaw`` (K,) about the vertical around groups of parts.

    ``owner`` int64 (P,), ascending, says to which group a part belongs; a group without parts is the point
    ``origin`` (K, 3).
    """
    seen = rotate(corners(parts), -yaw[owner][:, None])
    low, high = np.full((len(yaw), 3), np.inf), np.full((len(yaw), 3), -np.inf)
    if len(owner):
        first = np.flatnonzero(np.diff(owner, prepend=-1))
        low[owner[first]] = np.minimum.reduceat(seen.min(axis=1), first)
        high[owner[first]] = np.maximum.reduceat(seen.max(axis=1), first)
    bare = ~np.isfinite(low[:, 0])
    low[bare] = high[bare] = rotate(origin, -yaw)[bare]
    return rotate((low + high) / 2, yaw), (high - low) / 2


def part_tops(parts: Boxes) -> Floats:
    """Height of the highest point of each box, (P,)."""
    return parts.center[:, 2] + (np.abs(parts.axes[:, 2]) * parts.half).sum(axis=1)


def part_bottoms(parts: Boxes) -> Floats:
    """Height of the lowest point of each box, (P,)."""
    return parts.center[:, 2] - (np.abs(parts.axes[:, 2]) * parts.half).sum(axis=1)


def covers(parts: Boxes, point: Floats, margin: float = 0.0) -> Bools:
    """Which boxes, seen from above, a point (2,) lies in; for boxes with one axis upright."""
    offset = np.zeros((len(parts.center), 3))
    offset[:, :2] = point - parts.center[:, :2]
    along = np.abs(np.einsum("pij,pi->pj", parts.axes, offset))
    upright = np.abs(parts.axes[:, 2, :]) > 0.7
    return (upright | (along <= parts.half + margin)).all(axis=1)
