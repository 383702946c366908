"""Where surfaces meet: vertical contact, enclosure and gaps between meshes, for what boxes cannot tell."""

from __future__ import annotations

import numpy as np

from .arrays import Floats

Triangles = Floats
"""float64 (M, 3, 3): corners of triangles."""

GRID = 8
SAMPLES = 48
STEEPEST = 0.5
"""Surfaces bear objects up to the slope whose normal has this upward part: 60 degrees."""


def within(triangles: Triangles, low: Floats, high: Floats) -> Triangles:
    """The triangles whose boxes reach into an axis-aligned box."""
    inside = (triangles.min(axis=1) <= high) & (triangles.max(axis=1) >= low)
    return triangles[inside.all(axis=1)]


def heights(places: Floats, triangles: Triangles) -> Floats:
    """Height at which the vertical line through place k meets triangle m, float64 (K, M); NaN where it misses."""
    first, second, third = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    one, two = second - first, third - first
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        step = places[:, None, :] - first[None, :, :2]
        u = (step[..., 0] * two[:, 1] - step[..., 1] * two[:, 0]) / area
        v = (one[:, 0] * step[..., 1] - one[:, 1] * step[..., 0]) / area
        hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9)
        return np.where(hit, first[:, 2] + u * one[:, 2] + v * two[:, 2], np.nan)


def contact_heights(
    upper: Triangles, lower: Triangles, low: Floats, high: Floats, gap: float, overlap: float
) -> Floats:
    """Heights of the places where ``upper`` rests on ``lower``.

    The vertical lines through a grid and through points of both surfaces are
    followed within the axis-aligned box from ``low`` to ``high``.

    Parameters
    ----------
    gap, overlap
        How far above, and how deep in the lower surface a place still counts as contact, metres.

    Returns
    -------
    float64 (C,)
        Heights of the contacts; empty if there are none.
    """
    upper, lower = _bearing(within(upper, low, high)), _bearing(within(lower, low, high))
    if not len(upper) or not len(lower):
        return np.zeros(0)
    places = _places(upper, lower, low, high)
    above, below = _facing(places, upper, down=True), _facing(places, lower, down=False)
    space = above[:, :, None] - below[:, None, :]
    touching = (space <= gap) & (space >= -overlap)
    place, _, bearer = np.nonzero(touching)
    _, first = np.unique(place, return_index=True)
    return below[place[first], bearer[first]]


def _facing(places: Floats, triangles: Triangles, down: bool) -> Floats:
    """Heights of the surfaces that look down, or up; a line that meets only one surface takes it as it is."""
    found = heights(places, triangles)
    one, two = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    upward = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0] > 0
    single = np.isfinite(found).sum(axis=1) == 1
    return np.where((upward != down) | single[:, None], found, np.nan)


def _bearing(triangles: Triangles) -> Triangles:
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[np.abs(normal[:, 2]) > STEEPEST * np.linalg.norm(normal, axis=1)]


def _places(upper: Triangles, lower: Triangles, low: Floats, high: Floats) -> Floats:
    steps = (np.arange(GRID) + 0.5) / GRID
    grid = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    found = [low[:2] + grid * (high - low)[:2]]
    for triangles in (upper, lower):
        points = triangles.reshape(-1, 3)[:, :2]
        points = points[((points >= low[:2]) & (points <= high[:2])).all(axis=1)]
        found.append(points[:: max(1, len(points) // SAMPLES)])
    return np.concatenate(found)


def walls_around(point: Floats, triangles: Triangles, axes: Floats) -> Floats:
    """Distances from a point to a surface along and against each column of ``axes``, (3, 2) metres; inf for none."""
    found = np.full((3, 2), np.inf)
    local = (triangles - point) @ axes
    for axis in range(3):
        met = heights(np.zeros((1, 2)), local[:, :, [(axis + 1) % 3, (axis + 2) % 3, axis]])
        found[axis] = met[met >= 0].min(initial=np.inf), -met[met <= 0].max(initial=-np.inf)
    return found


def surface_gap(first: Triangles, second: Triangles) -> float:
    """Smallest distance found between corners, middles of edges and of faces of one surface and the other, metres."""
    if not len(first) or not len(second):
        return float("inf")
    return min(_nearest(_probes(first), second), _nearest(_probes(second), first))


def _probes(triangles: Triangles) -> Floats:
    middles = (triangles + np.roll(triangles, 1, axis=1)) / 2
    points = np.concatenate([triangles.reshape(-1, 3), middles.reshape(-1, 3), triangles.mean(axis=1)])
    return points[:: max(1, len(points) // 256)]


def _nearest(points: Floats, triangles: Triangles) -> float:
    """Smallest distance of points from triangles: to the face where the foot is on it, else to an edge.

    ``trimesh.triangles.closest_point`` says the same at the same speed, but to import it takes longer than to find
    the relations of a room, and triangles of no size make it divide by zero.
    """
    first = triangles[:, 0]
    one, two = triangles[:, 1] - first, triangles[:, 2] - first
    normal = np.cross(one, two)
    length = np.linalg.norm(normal, axis=1)
    flat = length <= 1e-300
    unit = normal / np.where(flat, 1.0, length)[:, None]
    step = points[:, None, :] - first
    height = np.einsum("kmi,mi->km", step, unit)
    foot = step - height[:, :, None] * unit
    scale = np.where(flat, 1.0, length)
    u = np.einsum("kmi,mi->km", np.cross(foot, two), unit) / scale
    v = np.einsum("kmi,mi->km", np.cross(one, foot), unit) / scale
    inside = (u >= 0) & (v >= 0) & (u + v <= 1) & ~flat
    best = float(np.abs(height[inside]).min(initial=np.inf))
    for start, stop in ((0, 1), (1, 2), (2, 0)):
        along = triangles[:, stop] - triangles[:, start]
        size = np.einsum("mi,mi->m", along, along)
        offset = points[:, None, :] - triangles[:, start]
        share = np.einsum("kmi,mi->km", offset, along) / np.where(size > 0, size, 1.0)
        rest = offset - np.clip(share, 0, 1)[:, :, None] * along
        best = min(best, float(np.sqrt((rest**2).sum(axis=2).min(initial=np.inf))))
    return best
