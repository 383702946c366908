"""Turns about the vertical, footprints and the gaps between them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def footprint_gap(
    center: NDArray[np.float64], half: NDArray[np.float64], yaw: float, places: NDArray[np.float64],
    other: NDArray[np.float64],
) -> NDArray[np.float64]:  # fmt: skip
    """Separation (T,) of a rectangle from others at places (T, 4), seen from above, metres; negative: they overlap.

    The largest along the axes of the two, of half extents ``half`` and ``other``.
    """
    dx, dy = (places[:, :2] - center[:2]).T
    cos, sin = np.abs(np.cos(places[:, 3] - yaw)), np.abs(np.sin(places[:, 3] - yaw))
    gaps = []
    for turn, own, them in ((np.full(len(places), yaw), half, other), (places[:, 3], other, half)):
        c, s = np.cos(turn), np.sin(turn)
        gaps.append(np.abs(c * dx + s * dy) - own[0] - cos * them[0] - sin * them[1])
        gaps.append(np.abs(c * dy - s * dx) - own[1] - sin * them[0] - cos * them[1])
    return np.max(gaps, axis=0)


def turned(points: NDArray[np.float64], angle: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """Points (..., 3) or (..., 2) turned about the vertical by angles (...,), radians."""
    cos, sin = np.cos(angle), np.sin(angle)
    result = np.array(points, np.float64)
    result[..., 0] = cos * points[..., 0] - sin * points[..., 1]
    result[..., 1] = sin * points[..., 0] + cos * points[..., 1]
    return result


def outside_rectangle(
    points: NDArray[np.float64], yaw: NDArray[np.float64] | float, half: NDArray[np.float64]
) -> NDArray[np.float64]:
    """How far points (..., 2) are outside of rectangles around the origin, turned by angles (...,), metres (...,).

    ``half`` (..., 2) are half extents.
    """
    beyond = np.maximum(np.abs(turned(points, -yaw)) - half, 0)
    return np.hypot(beyond[..., 0], beyond[..., 1])


def footprints(half: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Corners (T, 4, 2) of the box's footprint at places (T, 4), world metres."""
    cos, sin = np.cos(places[:, 3]), np.sin(places[:, 3])
    u = half[0] * np.stack([cos, sin], axis=1)
    v = half[1] * np.stack([-sin, cos], axis=1)
    return places[:, None, :2] + np.stack([u + v, v - u, -u - v, u - v], axis=1)


def heading(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn about the vertical, radians (...,), of the linear parts (..., 3, 3) of world matrices.

    The twist of a swing-twist decomposition: what is left, R_z(-heading) R, turns
    about a horizontal axis only.
    """
    return np.arctan2(linear[..., 1, 0] - linear[..., 0, 1], linear[..., 0, 0] + linear[..., 1, 1])


def turn(angle: float) -> NDArray[np.float64]:
    """The 4x4 matrix of a turn about the vertical, radians."""
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return matrix
