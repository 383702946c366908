"""The walls along a room's outline, how thick they are, and what is open in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.mask_outline import boxes_of, meets, ordered
from .looks import EYE
from .region import Region
from .structure import Opening, WallPiece

BESIDE = 0.12
"""Metres from an edge of the outline within which a cut belongs to its wall."""

THICKEST = 0.6
"""Metres of thickness of a wall at most: what is farther behind it is another one."""

PARALLEL = 0.3
"""Sine of the angle up to which a cut runs along a wall: round walls are many."""

CLOSED = 0.5
"""Share of an edge that has a wall, at least, at some height."""

STEP, NARROWEST = 0.05, 0.4
"""Openings are told at every so many metres along a wall, and are so wide at least."""

SILL, WAIST = 0.25, 1.0
"""Metres over the floor at which doors are open and windows closed, and at which most windows are open."""


@dataclass(frozen=True, eq=False)
class Cuts:
    """Where walls are cut at H heights over a floor: segments (S, 2, 2), the rows (S,) of their entities, and at which
    of the ``heights`` each was cut, ``level`` (S,); ``low`` and ``high`` (2, S) are the boxes around the segments."""

    heights: Floats
    segments: Floats
    row: Ints
    level: Ints
    low: Floats
    high: Floats

    @staticmethod
    def of(cuts: Mapping[float, tuple[Floats, Ints]]) -> Cuts:
        """The cuts at all heights together."""
        heights = sorted(cuts)
        segments = np.concatenate([cuts[height][0] for height in heights])
        row = np.concatenate([cuts[height][1] for height in heights])
        level = np.repeat(np.arange(len(heights)), [len(cuts[height][1]) for height in heights])
        return Cuts(np.array(heights), segments, row, level, *boxes_of(segments))

    def near(self, points: Floats, reach: float) -> Cuts:
        """Those that come within ``reach`` metres of the box around some points (P, 2), as far as their boxes tell."""
        some = meets(self.low, self.high, points, reach)
        return Cuts(
            self.heights, self.segments[some], self.row[some], self.level[some], self.low[:, some], self.high[:, some]
        )

    def nearest(self, height: float) -> int:
        """The number of the cut that is nearest to a height."""
        return int(np.abs(self.heights - height).argmin())


@dataclass(frozen=True, eq=False)
class CutsAlong:
    """Cuts as they are seen along an edge of so many metres: of both ends (S, 2) how far along it they are, and how far
    to its left, metres; ``along`` tells those that run as the edge does."""

    length: float
    place: Floats
    offset: Floats
    along: Bools
    cuts: Cuts

    @staticmethod
    def of(start: Floats, stop: Floats, cuts: Cuts) -> CutsAlong:
        """Those of some cuts that may be of a wall along an edge."""
        near = cuts.near(np.stack([start, stop]), BESIDE + THICKEST)
        along, step = stop - start, near.segments - start
        length = float(np.sqrt(along @ along))
        along = along / length
        place, offset = step @ along, step @ np.array([-along[1], along[0]])
        way = near.segments[:, 1] - near.segments[:, 0]
        runs = np.abs(offset[:, 1] - offset[:, 0]) <= PARALLEL * np.hypot(way[:, 0], way[:, 1])
        return CutsAlong(length, place, offset, runs, near)


def walls_along(outline: Floats, region: Region, cuts: Cuts) -> tuple[tuple[WallPiece, ...], tuple[Opening, ...]]:
    """The walls along the edges (K,) of an outline (K, 2), counter-clockwise, and what is open in them.

    Edges without a wall are left out.
    """
    found, opened = [], []
    top = region.ceiling if np.isfinite(region.ceiling) else region.lintel
    for start, stop in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        if np.linalg.norm(stop - start) < NARROWEST:
            continue
        near = CutsAlong.of(start, stop, cuts)
        if _closed(near, BESIDE).mean(axis=1).max() < CLOSED:
            continue
        thickness, row = _thickness_and_row(near)
        found.append(WallPiece(start, stop, thickness, region.floor, top, row))
        opened += _openings_in(found[-1], region, cuts, _closed(near, BESIDE + thickness))
    return tuple(found), tuple(opened)


def _openings_in(wall: WallPiece, region: Region, cuts: Cuts, closed: Bools) -> list[Opening]:
    """Doors, windows and passages of a wall: open at some heights where it is ``closed`` (H, steps) at others."""
    over, at_eyes, low, waist = (
        closed[cuts.nearest(height)] for height in (region.lintel - region.floor, EYE, SILL, WAIST)
    )
    kinds = np.select(
        [~at_eyes & ~waist & ~low & over, ~at_eyes & low, ~at_eyes & ~waist & ~low & ~over],
        ["door", "window", "passage"], "",
    )  # fmt: skip
    length, found = wall.length, []
    along = (wall.stop - wall.start) / length
    edges = [0, *(np.flatnonzero(kinds[1:] != kinds[:-1]) + 1).tolist(), len(kinds)]
    for first, last in pairwise(edges):
        begin, end = length * first / len(kinds), length * last / len(kinds)
        if not kinds[first] or end - begin < NARROWEST:
            continue
        open_at = closed[:, first:last].mean(axis=1) < 0.5
        bottom, top = _from_to(wall, region, cuts.heights, open_at, str(kinds[first]))
        found.append(Opening(str(kinds[first]), wall.start + begin * along, wall.start + end * along, bottom, top))
    return found


def _from_to(wall: WallPiece, region: Region, heights: Floats, open_at: Bools, kind: str) -> tuple[float, float]:
    """About from where to where something is open, between the heights at which the wall was cut."""
    opened = heights[open_at]
    bottom = region.floor if kind != "window" else region.floor + float(opened.min())
    over = heights[heights > opened.max()]
    return bottom, region.floor + float(over[0]) if len(over) else wall.top


def _closed(beside: CutsAlong, depth: float) -> Bools:
    """Where along an edge cuts run beside it, or up to ``depth`` metres behind it: bool (H, steps)."""
    cuts, steps = beside.cuts, max(round(beside.length / STEP), 1)
    low, high = ordered(beside.offset)
    near = beside.along & (high >= -depth) & (low <= BESIDE)
    begin, end = ordered(beside.place[near] / beside.length * steps - 0.5)
    first = np.ceil(begin).clip(0, steps).astype(int)
    last = (np.floor(end) + 1).clip(0, steps).astype(int)
    line, size = cuts.level[near] * (steps + 1), len(cuts.heights) * (steps + 1)
    count = np.bincount(line + first, minlength=size) - np.bincount(line + np.maximum(first, last), minlength=size)
    return np.asarray(np.cumsum(count.reshape(-1, steps + 1), axis=1)[:, :-1] > 0)


def _thickness_and_row(beside: CutsAlong) -> tuple[float, int]:
    """How far behind an edge the far side of its wall is (0 if there is none), and whose the near side is."""
    first, last = ordered(beside.place.clip(0, beside.length))
    shared, middle = last - first, (beside.offset[:, 0] + beside.offset[:, 1]) / 2
    mine = beside.along & (shared > STEP) & (middle <= BESIDE) & (middle >= -THICKEST)
    near = mine & (middle >= -BESIDE)
    rows, place_of = np.unique(beside.cuts.row[near], return_inverse=True)
    row = int(rows[np.bincount(place_of, shared[near]).argmax()]) if len(rows) else -1
    behind = mine & (middle < -0.02)
    if not behind.any() or shared[behind].sum() < 0.3 * shared[mine].sum():
        return 0.0, row
    longest = np.lexsort((middle[behind], shared[behind].round(2)))[-1]
    return -float(middle[behind][longest]), row
