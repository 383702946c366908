"""Where surfaces meet: vertical contact, enclosure and gaps between meshes, for what boxes cannot tell."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from .arrays import Bools, Floats, Ints
from .corner_ends import corner_ends, meeting_ends

Triangles = Floats
"""float64 (M, 3, 3): corners of triangles."""

GRID = 8
SAMPLES = 48
PROBES = 256
STEEPEST = 0.5
"""Surfaces bear objects up to the slope whose normal has this upward part: 60 degrees."""


SAME_HEIGHT = 1e-4
"""Metres within which a surface counts as the first, or the last, that a line meets."""

SIDES: tuple[Literal["left"], Literal["right"]] = ("left", "right")
"""How numpy names the two ends of equal values in a sorted array."""

AT_ONCE = 20_000
"""Triangles that are looked at together: some hundred places times as many numbers fit into memory."""


def within(triangles: Triangles, low: Floats, high: Floats) -> Triangles:
    """The triangles whose boxes reach into an axis-aligned box."""
    return triangles[meeting_ends(*corner_ends(triangles), low, high)]


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

    The vertical lines through a grid and through points of both surfaces are followed within the axis-aligned box
    from ``low`` to ``high``. Of ``upper`` counts what looks down, of ``lower`` what looks up. The lowest and the
    highest that a line meets of a surface do, however their normals look: sheets have but one side, and some meshes
    are turned inside out.

    Parameters
    ----------
    gap, overlap
        How far above, and how deep in the lower surface a place still counts as contact, metres.

    Returns
    -------
    float64 (C,)
        Heights of the contacts; empty if there are none.
    """
    near_upper, near_lower = bearing(within(upper, low, high)), bearing(within(lower, low, high))
    if not len(near_upper) or not len(near_lower):
        return np.zeros(0)
    places = _places(near_upper, near_lower, low, high)
    above, below = _hits(places, near_upper), _hits(places, near_lower)
    met = np.unique(above.place[_touching(above, below, gap, overlap)[0]])
    if not len(met):
        return np.zeros(0)
    above = _facing(above, met, near_upper, places, upper, down=True)
    below = _facing(below, met, near_lower, places, lower, down=False)
    touching, bearer = _touching(above, below, gap, overlap)
    _, first = np.unique(above.place[touching], return_index=True)
    return below.height[bearer[first]]


class _Hits(NamedTuple):
    """Where vertical lines meet triangles, by place and then by triangle: numbers of both and heights, (H,)."""

    place: Ints
    triangle: Ints
    height: Floats

    def take(self, chosen: Bools) -> _Hits:
        """Some of them."""
        return _Hits(self.place[chosen], self.triangle[chosen], self.height[chosen])


def _hits(places: Floats, triangles: Triangles) -> _Hits:
    found = []
    for begin in range(0, len(triangles), AT_ONCE):
        met = heights(places, triangles[begin : begin + AT_ONCE])
        place, triangle = np.nonzero(np.isfinite(met))
        found.append((place, triangle + begin, met[place, triangle]))
    place, triangle, height = (np.concatenate(columns) for columns in zip(*found, strict=True))
    order = np.argsort(place, kind="stable")
    return _Hits(place[order], triangle[order], height[order])


def _touching(above: _Hits, below: _Hits, gap: float, overlap: float) -> tuple[Ints, Ints]:
    """The pairs of hits at one place that touch: their numbers in ``above`` and in ``below``, ascending."""
    start, stop = (np.searchsorted(below.place, above.place, side=side) for side in SIDES)
    count = stop - start
    first = np.repeat(np.arange(len(count)), count)
    second = np.arange(len(first)) - np.repeat(np.cumsum(count) - count - start, count)
    space = above.height[first] - below.height[second]
    touches = (space <= gap) & (space >= -overlap)
    return first[touches], second[touches]


def _facing(hits: _Hits, met: Ints, near: Triangles, places: Floats, whole: Triangles, down: bool) -> _Hits:
    """The hits of the triangles ``near`` at the places ``met`` where the ``whole`` surface looks down, or up.

    Where a vertical line meets it first it looks down, and up where last, as one-sided sheets show no other side. Where
    the normals of both ends say the reverse, the mesh is inside out.
    """
    hits = hits.take(np.isin(hits.place, met))
    (up_low, up_high), (down_low, down_high) = column_ends(places[met], whole)
    inside_out = (down_high > up_high) & (up_low < down_low)
    end = np.minimum(up_low, down_low) if down else np.maximum(up_high, down_high)
    row = np.searchsorted(met, hits.place)
    looks = (looks_up(near)[hits.triangle] != inside_out[row]) != down
    return hits.take(looks | (np.abs(hits.height - end[row]) <= SAME_HEIGHT))


def looks_up(triangles: Triangles) -> Bools:
    """Which triangles look up, bool (M,)."""
    one, two = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    return one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0] > 0


def column_ends(places: Floats, triangles: Triangles) -> Floats:
    """Where vertical lines through places (K, 2) meet a surface first and last, metres: (2, 2, K).

    Of what looks up, and of what does not: the lowest and the highest; inf and -inf for none.
    """
    ends = np.full((2, 2, len(places)), np.inf)
    ends[:, 1] = -np.inf
    if not len(places):
        return ends
    low, high = (np.append(end, limit) for end, limit in ((places.min(axis=0), -np.inf), (places.max(axis=0), np.inf)))
    column = bearing(within(triangles, low, high))
    for begin in range(0, len(column), AT_ONCE):
        some = column[begin : begin + AT_ONCE]
        found, up = heights(places, some), looks_up(some)
        for side, mine in zip(ends, (found[:, up], found[:, ~up]), strict=True):
            side[0] = np.fmin(side[0], np.fmin.reduce(mine, axis=1, initial=np.inf))
            side[1] = np.fmax(side[1], np.fmax.reduce(mine, axis=1, initial=-np.inf))
    return ends


def bearing(triangles: Triangles) -> Triangles:
    """The triangles that are level enough to bear something, or to stand on something."""
    (a, b, c), (d, e, f) = ((triangles[:, end] - triangles[:, 0]).T for end in (1, 2))
    upward = a * e - b * d
    return triangles[(1 - STEEPEST**2) * upward**2 > STEEPEST**2 * ((b * f - c * e) ** 2 + (c * d - a * f) ** 2)]


def grid_places(low: Floats, high: Floats) -> Floats:
    """Places (GRID * GRID, 2), evenly over a box seen from above."""
    steps = (np.arange(GRID) + 0.5) / GRID
    return low[:2] + np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) * (high - low)[:2]


def _places(upper: Triangles, lower: Triangles, low: Floats, high: Floats) -> Floats:
    found = [grid_places(low, high)]
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
    """Smallest distance found between corners, middles of edges and of faces of one surface and the other, metres; 0
    where an edge of one goes through the other."""
    if not len(first) or not len(second):
        return float("inf")
    gap = min(_nearest(_probes(first), second), _nearest(_probes(second), first))
    return 0.0 if gap > 0 and (_pierces(first, second) or _pierces(second, first)) else gap


def _probes(triangles: Triangles) -> Floats:
    middles = (triangles + np.roll(triangles, 1, axis=1)) / 2
    points = np.concatenate([triangles.reshape(-1, 3), middles.reshape(-1, 3), triangles.mean(axis=1)])
    return points[:: max(1, len(points) // PROBES)]


def _pierces(first: Triangles, second: Triangles) -> bool:
    """Does an edge of ``first`` go through a triangle of ``second``?"""
    low, high = second.min(axis=(0, 1)), second.max(axis=(0, 1))
    first = within(first, low, high)
    if not len(first):
        return False
    second = within(second, first.min(axis=(0, 1)), first.max(axis=(0, 1)))
    edges = np.concatenate([first[:, [0, 1]], first[:, [1, 2]], first[:, [2, 0]]])
    edges = edges[:: max(1, len(edges) // PROBES)]
    corner, one, two = second[:, 0], second[:, 1] - second[:, 0], second[:, 2] - second[:, 0]
    normal = np.cross(one, two)
    along = edges[:, 1] - edges[:, 0]
    slope = along @ normal.T
    step = edges[:, 0, None] - corner
    with np.errstate(divide="ignore", invalid="ignore"):
        share = -np.einsum("kmi,mi->km", step, normal) / slope
        hit = (share > 0) & (share < 1) & (np.abs(slope) > 1e-12)
        edge, face = np.nonzero(hit)
    place = step[edge, face] + share[edge, face, None] * along[edge]
    square = np.einsum("ni,ni->n", normal[face], normal[face])
    u = np.einsum("ni,ni->n", np.cross(place, two[face]), normal[face]) / square
    v = np.einsum("ni,ni->n", np.cross(one[face], place), normal[face]) / square
    return bool(((u > 0) & (v > 0) & (u + v < 1)).any())


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
