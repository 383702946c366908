"""Oriented boxes as arrays: corners, reach, what they cover."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from .planar import turned


@dataclass(frozen=True, eq=False)
class Boxes:
    """Oriented boxes in the world, one per row.

    ``center`` (N, 3) metres; ``axes`` (N, 3, 3) orthonormal, axis k is the column
    ``axes[:, :, k]``; ``half`` (N, 3) half extents along them in metres; ``solid``
    bool (N,): False for rows without geometry (their box is a point).
    """

    center: NDArray[np.float64]
    axes: NDArray[np.float64]
    half: NDArray[np.float64]
    solid: NDArray[np.bool_]

    def take(self, rows: NDArray[np.integer]) -> Boxes:
        """The boxes of some rows."""
        return Boxes(self.center[rows], self.axes[rows], self.half[rows], self.solid[rows])


def turned_reach(half: NDArray[np.float64], turn: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """Half extents (..., 2) along x and y of a box of half extents (3,) that is turned by angles (...), radians."""
    cos, sin = np.abs(np.cos(turn)), np.abs(np.sin(turn))
    return np.stack([cos * half[0] + sin * half[1], sin * half[0] + cos * half[1]], axis=-1)


def orthonormal_axes(linear: NDArray[np.float64]) -> NDArray[np.float64]:
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


SIGNS = np.array(list(product((-1.0, 1.0), repeat=3)))
"""The eight corners of a cube from -1 to 1, the last axis fastest."""


def corners(boxes: Boxes) -> NDArray[np.float64]:
    """The corners of boxes, (N, 8, 3), in the order of :data:`SIGNS`."""
    return boxes.center[:, None] + (SIGNS * boxes.half[:, None]) @ np.swapaxes(boxes.axes, 1, 2)


def reach(boxes: Boxes) -> NDArray[np.float64]:
    """How far boxes reach from their middles along the world's axes, (N, 3)."""
    return (np.abs(boxes.axes) @ boxes.half[:, :, None])[:, :, 0]


def world_bounds(boxes: Boxes) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corners (N, 3) of boxes in the world."""
    far = reach(boxes)
    return boxes.center - far, boxes.center + far


def upright_axes(yaw: NDArray[np.float64]) -> NDArray[np.float64]:
    """Axes (..., 3, 3) turned about the vertical by angles (...,), radians: the matrices of these turns."""
    axes = np.zeros((*np.shape(yaw), 3, 3))
    axes[..., 0, 0] = axes[..., 1, 1] = np.cos(yaw)
    axes[..., 1, 0] = np.sin(yaw)
    axes[..., 0, 1], axes[..., 2, 2] = -axes[..., 1, 0], 1
    return axes


def upright_boxes(
    parts: Boxes, owner: NDArray[np.int64], yaw: NDArray[np.float64], origin: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centres and half extents (K, 3) of boxes turned by ``yaw`` (K,) about the vertical around groups of parts.

    ``owner`` int64 (P,), ascending, says to which group a part belongs; a group without parts is the point
    ``origin`` (K, 3).
    """
    seen = turned(corners(parts), -yaw[owner][:, None])
    low, high = np.full((len(yaw), 3), np.inf), np.full((len(yaw), 3), -np.inf)
    if len(owner):
        first = np.flatnonzero(np.diff(owner, prepend=-1))
        low[owner[first]] = np.minimum.reduceat(seen.min(axis=1), first)
        high[owner[first]] = np.maximum.reduceat(seen.max(axis=1), first)
    bare = ~np.isfinite(low[:, 0])
    low[bare] = high[bare] = turned(origin, -yaw)[bare]
    return turned((low + high) / 2, yaw), (high - low) / 2


def part_tops(parts: Boxes) -> NDArray[np.float64]:
    """Height of the highest point of each box, (P,)."""
    return parts.center[:, 2] + (np.abs(parts.axes[:, 2]) * parts.half).sum(axis=1)


def part_bottoms(parts: Boxes) -> NDArray[np.float64]:
    """Height of the lowest point of each box, (P,)."""
    return parts.center[:, 2] - (np.abs(parts.axes[:, 2]) * parts.half).sum(axis=1)


def covers(parts: Boxes, point: NDArray[np.float64], margin: float = 0.0) -> NDArray[np.bool_]:
    """Which boxes, seen from above, a point (2,) lies in; for boxes with one axis upright."""
    offset = np.zeros((len(parts.center), 3))
    offset[:, :2] = point - parts.center[:, :2]
    along = np.abs(np.einsum("pij,pi->pj", parts.axes, offset))
    upright = np.abs(parts.axes[:, 2, :]) > 0.7
    return (upright | (along <= parts.half + margin)).all(axis=1)
