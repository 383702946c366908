"""Lines that show what an action asks for: where, how near, how turned. Plain points, pairs of which are segments."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float64)
_EDGES = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b).bit_count() == 1])


def box_lines(low: Points, high: Points, matrix: Points) -> Points:
    """The 12 edges of a box, given by two corners (3,) in a frame, as segments (24, 3) in the world."""
    return moved(low + _CORNERS * (high - low), matrix)[_EDGES.ravel()]


def moved(points: Points, matrix: Points) -> Points:
    """Points (K, 3) moved by a matrix (4, 4)."""
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def circle(center: Points, first: Points, second: Points, parts: int = 32) -> Points:
    """A circle as segments (2 parts, 3); ``first`` and ``second`` (3,) are two of its radii at right angles."""
    turn = np.linspace(0, 2 * np.pi, parts + 1)
    points = center + np.outer(np.cos(turn), first) + np.outer(np.sin(turn), second)
    return np.repeat(points, 2, axis=0)[1:-1]


def sphere_lines(center: Points, radius: float) -> Points:
    """Three circles around a place: the distance within which a target has to come."""
    x, y, z = np.eye(3) * radius
    return np.concatenate([circle(center, x, y), circle(center, y, z), circle(center, z, x)])


def cone_lines(matrix: Points, angle: float, size: float) -> Points:
    """Cones around the x and z axes of a pose: its axes may point anywhere inside. ``angle`` up to pi, radians."""
    axes = matrix[:3, :3] / np.maximum(np.linalg.norm(matrix[:3, :3], axis=0), 1e-12)
    found = []
    for axis, one, two in ((0, 1, 2), (2, 0, 1)):
        along, wide = size * np.cos(angle), size * np.sin(angle)
        rim = circle(matrix[:3, 3] + along * axes[:, axis], wide * axes[:, one], wide * axes[:, two])
        spokes = np.stack([np.repeat(matrix[None, :3, 3], 4, axis=0), rim[:: len(rim) // 4][:4]], axis=1)
        found += [rim, spokes.reshape(-1, 3)]
    return np.concatenate(found)


def dashes(start: Points, stop: Points, count: int = 12) -> Points:
    """A dashed line between two places (3,), as segments (2 count, 3)."""
    steps = (np.arange(2 * count) / (2 * count - 1))[:, None]
    return start + steps * (stop - start)
