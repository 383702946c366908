"""Which of what is over the heads of people are beams, and part no rooms, as the lintels of walls do."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.grouped_ends import grouped_ends

SAME_WAY, SAME_LINE = 0.05, 0.15
"""Radians and metres within which segments lie along one line."""

GAP = 0.3
"""Metres between segments that belong together, at most."""

LONG, CARRIED = 1.0, 0.15
"""Metres of a beam, at least, and the share of it under which there is a wall: less is a beam, more a lintel."""


def is_beam(over: Floats, walls: Floats) -> Bools:
    """Which segments (S, 2, 2) over doors have no wall (W, 2, 2) under most of the line that they are part of."""
    found = np.zeros(len(over), bool)
    if not len(over) or not len(walls):
        return found
    middle = over.mean(axis=(0, 1))
    way, offset = _lines(over, middle)
    under_way, under_offset = _lines(walls, middle)
    size = np.hypot(*(over[:, 1] - over[:, 0]).T)
    for line in _long_lines(way, offset, size):
        angle, away = float(way[line[0]]), float(offset[line[0]])
        along = np.array([np.cos(angle), np.sin(angle)])
        place = np.sort((over[line] - middle) @ along, axis=1)
        turned = np.abs((under_way - angle + np.pi / 2) % np.pi - np.pi / 2)
        near = (turned <= 2 * SAME_WAY) & (np.abs(under_offset - away) <= 2 * SAME_LINE)
        carried = np.sort((walls[near] - middle) @ along, axis=1)
        found[line] = _uncarried(place, carried)
    return found


def _lines(segments: Floats, middle: Floats) -> tuple[Floats, Floats]:
    """Angle in [0, pi) and offset of the lines that segments (S, 2, 2) lie on, seen from a point."""
    step = segments[:, 1] - segments[:, 0]
    angle = np.arctan2(step[:, 1], step[:, 0]) % np.pi
    angle = np.where(angle > np.pi - SAME_WAY / 2, 0.0, angle)
    centre = segments.mean(axis=1) - middle
    return angle, centre[:, 1] * np.cos(angle) - centre[:, 0] * np.sin(angle)


def _long_lines(way: Floats, offset: Floats, size: Floats) -> list[Ints]:
    """Numbers of segments by line, of lines that are long enough for a beam together."""
    key = np.round(way / SAME_WAY).astype(np.int64) * 1_000_003 + np.round(offset / SAME_LINE).astype(np.int64)
    line = np.unique(key, return_inverse=True)[1]
    line[np.bincount(line, size)[line] < LONG] = -1
    order = np.argsort(line, kind="stable")
    order = order[np.searchsorted(line[order], 0) :]
    return np.split(order, np.flatnonzero(np.diff(line[order])) + 1) if len(order) else []


def _uncarried(place: Floats, carried: Floats) -> Bools:
    """Which intervals (S, 2) are part of a long run with hardly any of others (W, 2) beneath it."""
    order = np.argsort(place[:, 0])
    reached = np.maximum.accumulate(place[order, 1])
    run = np.concatenate([[0], np.cumsum(place[order[1:], 0] > reached[:-1] + GAP)])
    count = run[-1] + 1
    low, high = grouped_ends(run, count, place[order, 0], place[order, 1])
    beam = np.zeros(count, bool)
    for number in range(count):
        begin, end = carried.clip(low[number], high[number]).T
        length = high[number] - low[number]
        beam[number] = length > LONG and _covered(begin, end) < CARRIED * length
    found = np.zeros(len(place), bool)
    found[order] = beam[run]
    return found


def _covered(begin: Floats, end: Floats) -> float:
    """Length that intervals (W,) cover together."""
    if not len(begin):
        return 0.0
    order = np.argsort(begin)
    reached = np.concatenate([begin[order[:1]], np.maximum.accumulate(end[order])[:-1]])
    return float((end[order] - np.maximum(begin[order], reached)).clip(0).sum())
