"""The walls along a room's outline, how thick they are, and what is open in them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
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

Cuts = dict[float, tuple[Floats, Ints]]


def walls_along(outline: Floats, region: Region) -> tuple[WallPiece, ...]:
    """The walls along the edges (K,) of an outline (K, 2), counter-clockwise; edges without a wall are left out."""
    found = []
    for start, stop in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        length = float(np.linalg.norm(stop - start))
        if length < NARROWEST:
            continue
        closed = {height: _closed(start, stop, cut[0], BESIDE) for height, cut in region.cuts.items()}
        if max(part.mean() for part in closed.values()) < CLOSED:
            continue
        thickness, row = _thickness_and_row(start, stop, region.cuts)
        top = region.ceiling if np.isfinite(region.ceiling) else region.lintel
        found.append(WallPiece(start, stop, thickness, region.floor, top, row))
    return tuple(found)


def openings_in(wall: WallPiece, region: Region) -> tuple[Opening, ...]:
    """Doors, windows and passages of a wall: what is open at some heights where it is closed at others."""
    lintel = round(region.lintel - region.floor, 3)
    depth = BESIDE + wall.thickness
    closed = {height: _closed(wall.start, wall.stop, cut[0], depth) for height, cut in region.cuts.items()}
    over = closed[min(closed, key=lambda height: abs(height - lintel))]
    at_eyes, low, waist = closed[EYE], closed[SILL], closed[WAIST]
    kinds = np.select(
        [~at_eyes & ~waist & ~low & over, ~at_eyes & low, ~at_eyes & ~waist & ~low & ~over],
        ["door", "window", "passage"], "",
    )  # fmt: skip
    along = (wall.stop - wall.start) / wall.length
    found = []
    edges = [*np.flatnonzero(np.append(True, kinds[1:] != kinds[:-1])).tolist(), len(kinds)]
    for first, last in pairwise(edges):
        begin, end = wall.length * first / len(kinds), wall.length * last / len(kinds)
        if not kinds[first] or end - begin < NARROWEST:
            continue
        bottom, top = _from_to(wall, region, closed, slice(first, last), str(kinds[first]))
        found.append(Opening(str(kinds[first]), wall.start + begin * along, wall.start + end * along, bottom, top))
    return tuple(found)


def _from_to(
    wall: WallPiece, region: Region, closed: dict[float, Bools], part: slice, kind: str
) -> tuple[float, float]:
    """About from where to where something is open, between the heights at which the wall was cut."""
    heights = sorted(closed)
    open_at = [height for height in heights if closed[height][part].mean() < 0.5]
    bottom = region.floor if kind != "window" else region.floor + min(open_at)
    over = [height for height in heights if height > max(open_at)]
    return bottom, region.floor + over[0] if over else wall.top


def _closed(start: Floats, stop: Floats, segments: Floats, depth: float) -> Bools:
    """Where along an edge a cut runs beside it, or up to ``depth`` metres behind it, step by step."""
    length = float(np.linalg.norm(stop - start))
    steps = max(round(length / STEP), 1)
    place, offset = _seen_along(start, stop, segments)
    low, high = offset.min(axis=1), offset.max(axis=1)
    near = (high >= -depth) & (low <= BESIDE) & (np.abs(offset[:, 1] - offset[:, 0]) <= PARALLEL * _size(segments))
    first = np.ceil(place[near].min(axis=1) / length * steps - 0.5).clip(0, steps).astype(int)
    last = (np.floor(place[near].max(axis=1) / length * steps - 0.5) + 1).clip(0, steps).astype(int)
    count = np.zeros(steps + 1, int)
    np.add.at(count, first, 1)
    np.add.at(count, np.maximum(first, last), -1)
    return np.cumsum(count)[:-1] > 0


def _thickness_and_row(start: Floats, stop: Floats, cuts: Cuts) -> tuple[float, int]:
    """How far behind an edge the far side of its wall is (0 if there is none), and whose the near side is."""
    length = float(np.linalg.norm(stop - start))
    sides: list[tuple[float, float]] = []
    near: dict[int, float] = {}
    for segments, rows in cuts.values():
        place, offset = _seen_along(start, stop, segments)
        shared = place.max(axis=1).clip(0, length) - place.min(axis=1).clip(0, length)
        middle = offset.mean(axis=1)
        mine = (shared > STEP) & (np.abs(offset[:, 1] - offset[:, 0]) <= PARALLEL * _size(segments))
        for number in np.flatnonzero(mine & (middle <= BESIDE) & (middle >= -THICKEST)).tolist():
            sides.append((float(middle[number]), float(shared[number])))
            if middle[number] >= -BESIDE:
                near[int(rows[number])] = near.get(int(rows[number]), 0.0) + float(shared[number])
    behind = [(offset, shared) for offset, shared in sides if offset < -0.02]
    row = max(near, key=lambda key: near[key]) if near else -1
    if not behind or sum(shared for _, shared in behind) < 0.3 * sum(shared for _, shared in sides):
        return 0.0, row
    return -max(behind, key=lambda side: (round(side[1], 2), side[0]))[0], row


def _seen_along(start: Floats, stop: Floats, segments: Floats) -> tuple[Floats, Floats]:
    """Of both ends of segments (S, 2, 2): how far along an edge they are, and how far to its left, (S, 2) metres."""
    along = (stop - start) / np.linalg.norm(stop - start)
    step = segments - start
    return step @ along, step @ np.array([-along[1], along[0]])


def _size(segments: Floats) -> Floats:
    return np.asarray(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1))
