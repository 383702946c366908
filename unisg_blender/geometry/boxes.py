"""Oriented boxes as arrays: corners, reach, what they cover."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


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


_CORNERS = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)


def upright_box(parts: Boxes, yaw: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corner (3,) each, in the frame turned by ``yaw``, of the box around all parts."""
    corners = parts.center[:, None] + (_CORNERS * parts.half[:, None]) @ np.swapaxes(parts.axes, 1, 2)
    cos, sin = np.cos(yaw), np.sin(yaw)
    seen = corners.reshape(-1, 3) @ np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    return seen.min(axis=0), seen.max(axis=0)


def part_tops(parts: Boxes) -> NDArray[np.float64]:
    """Height of the highest point of each box, (P,)."""
    return parts.center[:, 2] + (np.abs(parts.axes[:, 2, :]) * parts.half).sum(axis=1)


def part_bottoms(parts: Boxes) -> NDArray[np.float64]:
    """Height of the lowest point of each box, (P,)."""
    return parts.center[:, 2] - (np.abs(parts.axes[:, 2, :]) * parts.half).sum(axis=1)


def covers(parts: Boxes, point: NDArray[np.float64], margin: float = 0.0) -> NDArray[np.bool_]:
    """Which boxes, seen from above, a point (2,) lies in; for boxes with one axis upright."""
    offset = np.zeros((len(parts.center), 3))
    offset[:, :2] = point - parts.center[:, :2]
    along = np.abs(np.einsum("pij,pi->pj", parts.axes, offset))
    upright = np.abs(parts.axes[:, 2, :]) > 0.7
    return (upright | (along <= parts.half + margin)).all(axis=1)


def world_bounds(boxes: Boxes) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corners (P, 3) of boxes in the world."""
    reach = (np.abs(boxes.axes) @ boxes.half[:, :, None])[:, :, 0]
    return boxes.center - reach, boxes.center + reach
