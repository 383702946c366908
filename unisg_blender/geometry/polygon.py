"""Polygons in the plane: area, inside, distance.

Short functions, for which shapely would put compiled wheels for every platform into Blender's zip.
"""

from __future__ import annotations

import numpy as np

from .arrays import Bools, Floats


def area(polygon: Floats) -> float:
    """Signed area of a polygon (K, 2), positive if counter-clockwise, square metres."""
    x, y = polygon.T
    return float(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def next_corners(polygon: Floats) -> Floats:
    """The corner that follows each corner of a polygon, (K, 2)."""
    return np.concatenate([polygon[1:], polygon[:1]])


def outside_distance(polygon: Floats, points: Floats) -> Floats:
    """How far points (..., 2) lie outside a polygon (K, 2), metres; 0 for points inside."""
    outside = ~inside(polygon, points)
    distance = np.zeros(outside.shape)
    if outside.any():  # mostly none are
        distance[outside] = np.linalg.norm(to_edges(polygon, points[outside]), axis=-1).min(axis=-1)
    return distance


def to_edges(polygon: Floats, points: Floats) -> Floats:
    """The shortest ways (..., K, 2) from points (..., 2) to each edge of a polygon (K, 2), metres."""
    edge = next_corners(polygon) - polygon
    offset = points[..., None, :] - polygon
    along = np.clip((offset * edge).sum(-1) / np.maximum((edge**2).sum(-1), 1e-18), 0, 1)
    return along[..., None] * edge - offset


def inside(polygon: Floats, points: Floats) -> Bools:
    """Which points (..., 2) lie inside a polygon (K, 2) of any shape (a ray to the right crosses it oddly often)."""
    (x0, y0), (x1, y1) = polygon.T, next_corners(polygon).T
    x, y = points[..., 0, None], points[..., 1, None]
    crosses = (y0 > y) != (y1 > y)
    height = np.where(y1 == y0, 1.0, y1 - y0)
    return (crosses & (x < x0 + (y - y0) * (x1 - x0) / height)).sum(axis=-1) % 2 == 1


def convex_hull(points: Floats) -> Floats:
    """The convex hull of points (N, 2), counter-clockwise (K, 2); fewer than three corners where it has no area."""
    order = np.unique(points, axis=0)
    if len(order) < 3:
        return order
    from scipy.spatial import ConvexHull, QhullError

    try:
        return points[ConvexHull(points).vertices]
    except QhullError:
        return order[[0, -1]]


def convex_gap(first: Floats, second: Floats) -> float:
    """Distance of two convex polygons (K, 2), metres; 0 where they overlap."""
    corners = np.concatenate([first, second])
    for polygon in (first, second):
        edge = next_corners(polygon) - polygon
        seen = corners @ np.stack([edge[:, 1], -edge[:, 0]])
        one, two = seen[: len(first)], seen[len(first) :]
        if ((one.min(axis=0) > two.max(axis=0)) | (two.min(axis=0) > one.max(axis=0))).any():
            return float(min(outside_distance(first, second).min(), outside_distance(second, first).min()))
    return 0.0


def without_straight_corners(polygon: Floats, straight: float = 1e-6) -> Floats:
    """A polygon (K, 2) without the corners at which it turns by an angle with a sine up to ``straight``."""
    before, after = polygon - np.roll(polygon, 1, axis=0), np.roll(polygon, -1, axis=0) - polygon
    bend = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    kept = np.abs(bend) > straight * np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    return polygon[kept] if kept.sum() >= 3 else polygon


def least_rectangle(points: Floats) -> tuple[Floats, Floats, float]:
    """The rectangle of least area around points (N, 2): middle (2,), half extents (2,), turn in radians.

    One of its sides runs along a side of the convex hull (Freeman and Shapira, 1975).
    """
    hull = convex_hull(points)
    edge = next_corners(hull) - hull
    angles = np.append(np.arctan2(edge[:, 1], edge[:, 0]) % (np.pi / 2), 0.0)
    cos, sin = np.cos(angles), np.sin(angles)
    seen = np.stack([np.outer(cos, hull[:, 0]) + np.outer(sin, hull[:, 1]),
                     np.outer(cos, hull[:, 1]) - np.outer(sin, hull[:, 0])], axis=2)  # fmt: skip
    low, high = seen.min(axis=1), seen.max(axis=1)
    best = int((high - low).prod(axis=1).argmin())
    x, y = (low[best] + high[best]) / 2
    middle = np.array([cos[best] * x - sin[best] * y, sin[best] * x + cos[best] * y])
    return middle, (high[best] - low[best]) / 2, float(angles[best])
