"""Polygons around groups of cells, all at once: traced along the sides of cells, and simplified."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .arrays import Bools, Floats, Ints
from .column_raster import Grid

STEPS = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
"""Along the lower side of a cell, then its far side, its upper side and back: inside is on the left."""

CORNERS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
"""Where each side of a cell begins."""

OUTWARD = np.array([[0, -1], [1, 0], [0, 1], [-1, 0]])
"""The cell beyond each side."""


def outlines_of(group: Ints, i: Ints, j: Ints, grid: Grid) -> list[list[Floats]]:
    """The polygons (K, 2), metres, around the cells (i, j) of each group, largest first.

    Groups are numbered from 0, each cell is in a group once. Around is counter-clockwise, holes clockwise; cells that
    share only a corner are apart.
    """
    count = int(group.max(initial=-1)) + 1
    found: list[list[Floats]] = [[] for _ in range(count)]
    if not count:
        return found
    wide = int(j.max() - j.min()) + 3
    size = wide * (int(i.max() - i.min()) + 3)
    cell = group * size + (i - i.min() + 1) * wide + (j - j.min() + 1)
    known = np.sort(cell)
    beyond = cell + (OUTWARD @ [wide, 1])[:, None]
    side, owner = np.nonzero(~_among(known, beyond))
    corner = cell[owner] + CORNERS[side] @ [wide, 1]
    following = _following(corner, side, STEPS @ [wide, 1])
    place = np.stack([i[owner], j[owner]], axis=1) + CORNERS[side]
    points = place * grid.cell + grid.origin
    for loop in _loops(following, side):
        found[int(group[owner[loop[0]]])].append(points[loop])
    return [sorted(polygons, key=_width, reverse=True) if len(polygons) > 1 else polygons for polygons in found]


def _width(polygon: Floats) -> float:
    """The area of the box around a polygon: what is around others has the larger one."""
    size = polygon.max(axis=0) - polygon.min(axis=0)
    return float(size[0] * size[1])


def _among(known: Ints, keys: Ints) -> Bools:
    """Which keys are among some sorted ones."""
    place = np.searchsorted(known, keys)
    return np.asarray(known[place.clip(max=len(known) - 1)] == keys)


def _following(corner: Ints, side: Ints, steps: Ints) -> Ints:
    """The side after each: to the left if there is one, else straight on, else to the right."""
    key = corner * 4 + side
    order = np.argsort(key)
    end, after = corner + steps[side], np.full(len(side), -1)
    for turn in (3, 0, 1):
        wanted = end * 4 + (side + turn) % 4
        place = np.searchsorted(key[order], wanted).clip(max=len(key) - 1)
        after = np.where(key[order][place] == wanted, order[place], after)
    return after


def _loops(following: Ints, side: Ints) -> list[list[int]]:
    """The loops of sides, each as the sides that begin at a corner where it turns."""
    after, turns = following.tolist(), np.zeros(len(side), bool)
    turns[following] = side[following] != side
    is_turn, fresh, found = turns.tolist(), [True] * len(side), []
    for start in np.flatnonzero(turns).tolist():
        loop, place = [], start
        while fresh[place]:
            fresh[place] = False
            if is_turn[place]:
                loop.append(place)
            place = after[place]
        if loop:
            found.append(loop)
    return found


def simplified_all(polygons: Sequence[Floats], tolerance: float) -> list[Floats]:
    """Polygons (K, 2) with fewer corners, none of which was farther than ``tolerance`` metres from the new edges.

    By halves (Ramer, 1972; Douglas and Peucker, 1973), from the two corners that are farthest apart; all at once.
    """
    if not polygons:
        return []
    rings, ends = [], []
    for polygon in polygons:
        first = int(((polygon - polygon.mean(axis=0)) ** 2).sum(axis=1).argmax())
        ring = np.concatenate([polygon[first:], polygon[:first], polygon[first : first + 1]])
        ends.append(int(((ring - ring[0]) ** 2).sum(axis=1).argmax()))
        rings.append(ring)
    base = np.cumsum([0, *(len(ring) for ring in rings)])
    points, kept = np.concatenate(rings), np.zeros(base[-1], bool)
    middle = base[:-1] + np.array(ends)
    kept[base[:-1]] = kept[middle] = True
    start, stop = np.concatenate([base[:-1], middle]), np.concatenate([middle, base[1:] - 1])
    while len(start):
        worst, far = _farthest(points, start, stop)
        split = far > tolerance
        start, worst, stop = start[split], worst[split], stop[split]
        kept[worst] = True
        start, stop = np.concatenate([start, worst]), np.concatenate([worst, stop])
    return [ring[kept[first : first + len(ring)]] for ring, first in zip(rings, base, strict=False)]


def _farthest(points: Floats, start: Ints, stop: Ints) -> tuple[Ints, Floats]:
    """Of the points between the ends of chains the one that is farthest from their chord, and how far; -1 for none."""
    count = (stop - start - 1).clip(0)
    some = np.flatnonzero(count)
    worst, far = np.full(len(start), -1), np.full(len(start), -1.0)
    if not len(some):
        return worst, far
    first = np.cumsum(count[some]) - count[some]
    entry = np.repeat(some, count[some])
    place = start[entry] + 1 + np.arange(len(entry)) - np.repeat(first, count[some])
    along = points[stop] - points[start]
    step = points[place] - points[start[entry]]
    length = np.maximum((along**2).sum(axis=1), 1e-18)
    share = ((step * along[entry]).sum(axis=1) / length[entry]).clip(0, 1)
    off = np.linalg.norm(step - share[:, None] * along[entry], axis=1)
    far[some] = np.maximum.reduceat(off, first)
    worst[some] = np.minimum.reduceat(np.where(off == far[entry], place, len(points)), first)
    return worst, far
