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
    known = key[order]
    end, after = corner + steps[side], np.full(len(side), -1)
    for turn in (3, 0, 1):
        wanted = end * 4 + (side + turn) % 4
        place = np.searchsorted(known, wanted).clip(max=len(key) - 1)
        after = np.where(known[place] == wanted, order[place], after)
    return after


def _loops(following: Ints, side: Ints) -> list[Ints]:
    """The loops of sides, each as the sides that begin at a corner where it turns, from the lowest number on.

    All at once: what is next is looked up for twice as many steps each time.
    """
    turns = np.zeros(len(side), bool)
    turns[following] = side[following] != side
    next_turn = following
    while not turns[next_turn].all():  # twice as far along straight runs each time
        next_turn = np.where(turns[next_turn], next_turn, next_turn[next_turn])
    corners = np.flatnonzero(turns)
    each, after = np.arange(len(corners)), np.searchsorted(corners, next_turn[corners])
    doublings = range(len(corners).bit_length())
    lowest, ahead = each, after
    for _ in doublings:
        lowest, ahead = np.minimum(lowest, lowest[ahead]), ahead[ahead]
    left, ahead = (each != lowest).astype(np.int64), np.where(each == lowest, each, after)
    for _ in doublings:
        left, ahead = left + left[ahead], ahead[ahead]
    order = np.lexsort((-left, left > 0, lowest))
    return np.split(corners[order], np.flatnonzero(np.diff(lowest[order])) + 1)


def simplified_all(polygons: Sequence[Floats], tolerance: float) -> list[Floats]:
    """Polygons (K, 2) with fewer corners, none of which was farther than ``tolerance`` metres from the new edges.

    By halves (Ramer, 1972; Douglas and Peucker, 1973), from the two corners that are farthest apart; all at once.
    """
    if not polygons:
        return []
    rings, size = np.concatenate(polygons), np.array([len(polygon) for polygon in polygons])
    begin = np.cumsum(size) - size
    middles = np.add.reduceat(rings, begin) / size[:, None]
    first = _farthest_from(middles, rings, begin, size)
    base = np.append(0, np.cumsum(size + 1))
    step = np.arange(base[-1]) - np.repeat(base[:-1], size + 1)
    entry = np.repeat(np.arange(len(size)), size + 1)
    points, kept = rings[begin[entry] + (first[entry] + step) % size[entry]], np.zeros(base[-1], bool)
    middle = base[:-1] + _farthest_from(points[base[:-1]], points, base[:-1], size + 1)
    kept[base[:-1]] = kept[middle] = True
    start, stop = np.concatenate([base[:-1], middle]), np.concatenate([middle, base[1:] - 1])
    while len(start):
        worst, far = _farthest(points, start, stop)
        split = far > tolerance
        start, worst, stop = start[split], worst[split], stop[split]
        kept[worst] = True
        start, stop = np.concatenate([start, worst]), np.concatenate([worst, stop])
    return np.split(points[kept], np.cumsum(np.add.reduceat(kept.astype(int), base[:-1]))[:-1])


def _farthest_from(places: Floats, points: Floats, begin: Ints, size: Ints) -> Ints:
    """Of each of some runs of points, which begin there and are so long, the first that is farthest from its place."""
    entry = np.repeat(np.arange(len(size)), size)
    away = ((points - places[entry]) ** 2).sum(axis=1)
    best = np.flatnonzero(away == np.maximum.reduceat(away, begin)[entry])
    return best[np.searchsorted(best, begin)] - begin


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
