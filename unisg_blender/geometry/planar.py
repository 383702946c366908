"""Turns about the vertical, rectangles that are turned, and the gaps between them."""

from __future__ import annotations

import numpy as np

from .arrays import Floats

Angles = Floats | float


def rotate(points: Floats, angle: Angles) -> Floats:
    """Points (..., 2) or (..., 3) turned about the vertical by angles (...,), radians; both broadcast."""
    return rotate_by(points, np.cos(angle), np.sin(angle))


def rotate_by(points: Floats, cos: Angles, sin: Angles) -> Floats:
    """The same for angles with these cosines and sines (...,)."""
    x, y = points[..., 0], points[..., 1]
    turned_x = cos * x - sin * y
    result = np.empty((*np.shape(turned_x), points.shape[-1]))
    result[..., 0], result[..., 1], result[..., 2:] = turned_x, sin * x + cos * y, points[..., 2:]
    return result


def rotation(angle: Angles) -> Floats:
    """The matrices (..., 3, 3) of turns about the vertical by angles (...,), radians."""
    matrix = np.zeros((*np.shape(angle), 3, 3))
    matrix[..., 0, 0] = matrix[..., 1, 1] = np.cos(angle)
    matrix[..., 1, 0], matrix[..., 2, 2] = np.sin(angle), 1
    matrix[..., 0, 1] = -matrix[..., 1, 0]
    return matrix


def turn(angle: float) -> Floats:
    """The 4x4 matrix of a turn about the vertical, radians."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation(angle)
    return matrix


def heading(linear: Floats) -> Floats:
    """Turn about the vertical, radians (...,), of the linear parts (..., 3, 3) of world matrices.

    The twist of a swing-twist decomposition: what is left, R_z(-heading) R, turns
    about a horizontal axis only.
    """
    return np.arctan2(linear[..., 1, 0] - linear[..., 0, 1], linear[..., 0, 0] + linear[..., 1, 1])


def wrapped(angle: Floats) -> Floats:
    """Angles in [-pi, pi)."""
    return (angle + np.pi) % (2 * np.pi) - np.pi


def turned_reach(half: Floats, angle: Angles) -> Floats:
    """How far rectangles of half extents (..., 2) reach along x and y, (..., 2), turned by angles (...,), radians."""
    cos, sin = np.abs(np.cos(angle)), np.abs(np.sin(angle))
    return np.stack([cos * half[..., 0] + sin * half[..., 1], sin * half[..., 0] + cos * half[..., 1]], axis=-1)


def rectangle_gap(offset: Floats, yaw: Angles, half: Floats, other_yaw: Angles, other_half: Floats) -> Floats:
    """Separation (...,) of rectangles from others whose middles are at ``offset`` (..., 2), metres; all broadcast.

    The largest along the axes of the two, which are turned by angles and have half extents (..., 2). Negative: they
    overlap.
    """
    spin = np.asarray(other_yaw) - yaw
    cos, sin = np.abs(np.cos(spin)), np.abs(np.sin(spin))
    gaps = []
    for turn, mine, others in ((yaw, half, other_half), (other_yaw, other_half, half)):
        seen = np.abs(rotate(offset, -np.asarray(turn)))
        gaps.append(seen[..., 0] - mine[..., 0] - (cos * others[..., 0] + sin * others[..., 1]))
        gaps.append(seen[..., 1] - mine[..., 1] - (sin * others[..., 0] + cos * others[..., 1]))
    return np.maximum(np.maximum(gaps[0], gaps[1]), np.maximum(gaps[2], gaps[3]))


def footprint_gap(center: Floats, half: Floats, yaw: float, places: Floats, other: Floats) -> Floats:
    """:func:`rectangle_gap` (T,) of a box's footprint to that of another of half extents ``other`` at places (T, 4)."""
    return rectangle_gap(places[:, :2] - center[:2], yaw, half, places[:, 3], other)


def outside_rectangle(points: Floats, yaw: Angles, half: Floats) -> Floats:
    """How far points (..., 2) are outside of rectangles around the origin, turned by angles (...,), metres (...,).

    ``half`` (..., 2) are half extents.
    """
    beyond = np.maximum(np.abs(rotate(points, -np.asarray(yaw))) - half, 0)
    return np.hypot(beyond[..., 0], beyond[..., 1])


def footprints(half: Floats, places: Floats) -> Floats:
    """Corners (T, 4, 2) of the box's footprint at places (T, 4), world metres, counter-clockwise."""
    corners = half[:2] * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    return places[:, None, :2] + rotate(corners, places[:, 3:])
