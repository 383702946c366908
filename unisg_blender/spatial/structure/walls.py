"""The walls along a room's outline, how thick they are, and what is open in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.mask_outline import boxes_of, meets, ordered
from .looks import EYE
from .storeys import Region
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
    of the ``heights`` each was cut, ``level`` (S,)."""

    heights: Floats
    segments: Floats
    row: Ints
    level: Ints

    @staticmethod
    def around(cuts: Mapping[float, tuple[Floats, Ints]], low: Floats, high: Floats) -> Cuts:
        """The cuts that reach into a rectangle, as far as their boxes tell."""
        heights = sorted(cuts)
        segments = np.concatenate([cuts[height][0] for height in heights])
        row = np.concatenate([cuts[height][1] for height in heights])
        level = np.repeat(np.arange(len(heights)), [len(cuts[height][1]) for height in heights])
        near = reach_into(segments, low, high)
        return Cuts(np.array(heights), segments[near], row[near], level[near])

    @cached_property
    def boxes(self) -> tuple[Floats, Floats]:
        """The corners of the boxes around the segments, (2, S) each."""
        return boxes_of(self.segments)

    def beside(self, start: Floats, stop: Floats) -> Cuts:
        """Those that may be of a wall along an edge."""
        near = meets(*self.boxes, np.stack([start, stop]), BESIDE + THICKEST)
        return Cuts(self.heights, self.segments[near], self.row[near], self.level[near])

    def nearest(self, height: float) -> int:
        """The number of the cut that is nearest to a height."""
        return int(np.abs(self.heights - height).argmin())


def reach_into(segments: Floats, low: Floats, high: Floats) -> Bools:
    """Which segments (S, 2, 2) reach into a rectangle, as far as their boxes tell."""
    start, stop = segments[:, 0], segments[:, 1]
    reached = (np.minimum(start, stop) <= high) & (np.maximum(start, stop) >= low)
    return np.asarray(reached[:, 0] & reached[:, 1])


def walls_along(outline: Floats, region: Region, cuts: Cuts) -> tuple[WallPiece, ...]:
    """The walls along the edges (K,) of an outline (K, 2), counter-clockwise; edges without a wall are left out."""
    found = []
    top = region.ceiling if np.isfinite(region.ceiling) else region.lintel
    for start, stop in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        if np.linalg.norm(stop - start) < NARROWEST:
            continue
        near = cuts.beside(start, stop)
        if _closed(start, stop, near, BESIDE).mean(axis=1).max() < CLOSED:
            continue
        thickness, row = _thickness_and_row(start, stop, near)
        found.append(WallPiece(start, stop, thickness, region.floor, top, row))
    return tuple(found)


def openings_in(wall: WallPiece, region: Region, cuts: Cuts) -> tuple[Opening, ...]:
    """Doors, windows and passages of a wall: what is open at some heights where it is closed at others."""
    closed = _closed(wall.start, wall.stop, cuts.beside(wall.start, wall.stop), BESIDE + wall.thickness)
    over, at_eyes, low, waist = (
        closed[cuts.nearest(height)] for height in (region.lintel - region.floor, EYE, SILL, WAIST)
    )
    kinds = np.select(
        [~at_eyes & ~waist & ~low & over, ~at_eyes & low, ~at_eyes & ~waist & ~low & ~over],
        ["door", "window", "passage"], "",
    )  # fmt: skip
    along = (wall.stop - wall.start) / wall.length
    found = []
    edges = [0, *(np.flatnonzero(kinds[1:] != kinds[:-1]) + 1).tolist(), len(kinds)]
    for first, last in pairwise(edges):
        begin, end = wall.length * first / len(kinds), wall.length * last / len(kinds)
        if not kinds[first] or end - begin < NARROWEST:
            continue
        open_at = closed[:, first:last].mean(axis=1) < 0.5
        bottom, top = _from_to(wall, region, cuts.heights, open_at, str(kinds[first]))
        found.append(Opening(str(kinds[first]), wall.start + begin * along, wall.start + end * along, bottom, top))
    return tuple(found)


def _from_to(wall: WallPiece, region: Region, heights: Floats, open_at: Bools, kind: str) -> tuple[float, float]:
    """About from where to where something is open, between the heights at which the wall was cut."""
    opened = heights[open_at]
    bottom = region.floor if kind != "window" else region.floor + float(opened.min())
    over = heights[heights > opened.max()]
    return bottom, region.floor + float(over[0]) if len(over) else wall.top


def _closed(start: Floats, stop: Floats, cuts: Cuts, depth: float) -> Bools:
    """Where along an edge cuts run beside it, or up to ``depth`` metres behind it: bool (H, steps)."""
    length = float(np.linalg.norm(stop - start))
    steps = max(round(length / STEP), 1)
    place, offset = _seen_along(start, stop, cuts.segments)
    low, high = ordered(offset)
    near = (high >= -depth) & (low <= BESIDE) & (high - low <= PARALLEL * _size(cuts.segments))
    begin, end = ordered(place[near] / length * steps - 0.5)
    first = np.ceil(begin).clip(0, steps).astype(int)
    last = (np.floor(end) + 1).clip(0, steps).astype(int)
    count = np.zeros((len(cuts.heights), steps + 1), int)
    np.add.at(count, (cuts.level[near], first), 1)
    np.add.at(count, (cuts.level[near], np.maximum(first, last)), -1)
    return np.asarray(np.cumsum(count, axis=1)[:, :-1] > 0)


def _thickness_and_row(start: Floats, stop: Floats, cuts: Cuts) -> tuple[float, int]:
    """How far behind an edge the far side of its wall is (0 if there is none), and whose the near side is."""
    length = float(np.linalg.norm(stop - start))
    place, offset = _seen_along(start, stop, cuts.segments)
    first, last = ordered(place.clip(0, length))
    shared, middle = last - first, (offset[:, 0] + offset[:, 1]) / 2
    mine = (shared > STEP) & (np.abs(offset[:, 1] - offset[:, 0]) <= PARALLEL * _size(cuts.segments))
    mine &= (middle <= BESIDE) & (middle >= -THICKEST)
    near = mine & (middle >= -BESIDE)
    rows, place_of = np.unique(cuts.row[near], return_inverse=True)
    row = int(rows[np.bincount(place_of, shared[near]).argmax()]) if len(rows) else -1
    behind = mine & (middle < -0.02)
    if not behind.any() or shared[behind].sum() < 0.3 * shared[mine].sum():
        return 0.0, row
    longest = np.lexsort((middle[behind], shared[behind].round(2)))[-1]
    return -float(middle[behind][longest]), row


def _seen_along(start: Floats, stop: Floats, segments: Floats) -> tuple[Floats, Floats]:
    """Of both ends of segments (S, 2, 2): how far along an edge they are, and how far to its left, (S, 2) metres."""
    along = (stop - start) / np.linalg.norm(stop - start)
    step = segments - start
    return step @ along, step @ np.array([-along[1], along[0]])


def _size(segments: Floats) -> Floats:
    way = segments[:, 1] - segments[:, 0]
    return np.asarray(np.hypot(way[:, 0], way[:, 1]))
