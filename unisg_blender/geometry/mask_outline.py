"""Polygons around the cells of a grid: traced, simplified, and moved onto the lines that they follow."""

from __future__ import annotations

from typing import Any

import numpy as np

from .arrays import Bools, Floats, Ints
from .column_raster import Grid
from .polygon import without_straight_corners
from .traced_outlines import outlines_of, simplified_all

PARALLEL = 0.2
"""Sine of the angle up to which a line runs along an edge: about 12 degrees."""

BEYOND, BEFORE = 2.2, 0.8
"""Cells within which a line is near an edge, on its outer and its inner side: cells that it goes through are out."""

FAR_CORNER = 8.0
"""Cells by which a corner may be moved to where two lines meet: in sharp corners the cells end early."""

FOLLOWED, RIVAL = 0.3, 0.6
"""Share of an edge that lines must accompany, at least, to be what it follows; and share of what the best one does from
which on another counts: then the inner one is taken, as of the two faces of a thin wall."""

STRAIGHT = 1e-3
"""Sine of the angle by which an outline turns at a corner, at least."""

SAME_LINE = 0.1
"""Cells within which lines count as one."""


def outlines(mask: Bools, grid: Grid) -> list[Floats]:
    """The polygons (K, 2) around the true cells, metres, largest first; around is counter-clockwise, holes clockwise.

    Cells that share only a corner are apart.
    """
    i, j = np.nonzero(mask)
    return outlines_of(np.zeros(len(i), np.int64), i, j, grid)[0] if len(i) else []


def simplified(polygon: Floats, tolerance: float) -> Floats:
    """A polygon (K, 2) with fewer corners; see :func:`~.traced_outlines.simplified_all`."""
    return simplified_all([polygon], tolerance)[0]


def snapped(polygon: Floats, segments: Floats, cell: float) -> Floats:
    """The polygon (K, 2) with its edges moved onto those of some segments (S, 2, 2) that they follow, metres.

    An edge is traced to about ``cell``; of the lines beside it the one is taken that accompanies it longest. Edges
    that follow none stay where they are. Corners are where neighbouring lines meet; where that is far away, as of
    parallel ones, the outline steps from one to the other.
    """
    low, high = boxes_of(segments)
    lines = []
    ends = np.stack([polygon, np.roll(polygon, -1, 0)], axis=1)
    for edge in ends:
        near = meets(low, high, edge, (BEYOND + 1) * cell)
        lines.append(_followed(edge[0], edge[1], segments[near], cell))
    corners: list[Floats] = []
    for number, place in enumerate(polygon):
        before, after = lines[number - 1], lines[number]
        meeting = _meeting(before, after)
        if meeting is not None and np.linalg.norm(meeting - place) <= FAR_CORNER * cell:
            corners.append(meeting)
        else:
            corners += [point + ((place - point) @ along) * along for point, along in (before, after)]
    found = np.array(corners)
    found = found[np.linalg.norm(found - np.roll(found, 1, axis=0), axis=1) > 1e-6]
    return without_straight_corners(found, STRAIGHT) if len(found) >= 3 else polygon


def _followed(start: Floats, stop: Floats, segments: Floats, cell: float) -> tuple[Floats, Floats]:
    """A point and the direction of the line that an edge follows; the edge's own where it follows none."""
    along = stop - start
    length = float(np.sqrt(along @ along))
    along = along / max(length, 1e-12)
    step = segments - start
    offset, place = step @ np.array([-along[1], along[0]]), step @ along
    low, high = ordered(place.clip(0, length))
    beside = _offset_beside(offset, place, (low + high) / 2)
    near = (beside >= -BEYOND * cell) & (beside <= BEFORE * cell) & (high - low > 0)
    (chosen,) = near.nonzero()
    way = segments[chosen, 1] - segments[chosen, 0]
    slanted = np.abs(offset[chosen, 1] - offset[chosen, 0])
    chosen = chosen[slanted <= PARALLEL * np.hypot(way[:, 0], way[:, 1])]
    if not len(chosen):
        return start, along
    away = beside[chosen]
    order = away.argsort(kind="stable")
    chosen, away = chosen[order], away[order]
    shared = (high - low)[chosen]
    group = np.append(0, (away[1:] - away[:-1] > SAME_LINE * cell).cumsum())
    total = np.bincount(group, shared)  # what overlaps counts twice so far, so less than this cannot be more
    for each in (total >= RIVAL * FOLLOWED * length).nonzero()[0].tolist():
        some = chosen[group == each]
        total[each] = _covered(low[some], high[some])
    if total.max() < FOLLOWED * length:
        return start, along
    best = int(np.flatnonzero(total >= RIVAL * total.max())[-1])
    mine = chosen[group == best]
    longest = segments[mine[shared[group == best].argmax()]]
    way = longest[1] - longest[0]
    return longest[0], way / np.linalg.norm(way) * np.sign(way @ along)


def _covered(low: Floats, high: Floats) -> float:
    """Length that intervals (S,) cover together."""
    if len(low) == 1:
        return max(float(high[0] - low[0]), 0.0)
    order = low.argsort()
    low, high = low[order], high[order]
    reached = np.concatenate([low[:1], np.maximum.accumulate(high)[:-1]])
    return float((high - np.maximum(low, reached)).clip(0).sum())


def _offset_beside(offset: Floats, place: Floats, at: Floats) -> Floats:
    """How far beside an edge segments are, at places (S,) along it."""
    run = place[:, 1] - place[:, 0]
    share = np.divide(at - place[:, 0], run, out=np.full(len(run), 0.5), where=np.abs(run) > 1e-12)
    return offset[:, 0] + share * (offset[:, 1] - offset[:, 0])


def _meeting(first: tuple[Floats, Floats], second: tuple[Floats, Floats]) -> Floats | None:
    """Where two lines meet; None for parallel ones."""
    (point, along), (other, across) = first, second
    turn = float(along[0] * across[1] - along[1] * across[0])
    if abs(turn) < 1e-6:
        return None
    step = other - point
    return point + (step[0] * across[1] - step[1] * across[0]) / turn * along


def components(mask: Bools) -> tuple[Ints, int]:
    """Numbers of the connected regions of a mask, 1 and up, 0 outside; cells are neighbours by their sides."""
    from scipy.ndimage import label

    labelled: Any = label(mask)
    return labelled[0].astype(np.int64), int(labelled[1])


def grown(mask: Bools) -> Bools:
    """A mask with the cells that share a side with it."""
    found = mask.copy()
    found[1:] |= mask[:-1]
    found[:-1] |= mask[1:]
    found[:, 1:] |= mask[:, :-1]
    found[:, :-1] |= mask[:, 1:]
    return found


def ordered(pairs: Floats) -> tuple[Floats, Floats]:
    """The smaller and the larger of pairs (N, 2)."""
    return np.minimum(pairs[:, 0], pairs[:, 1]), np.maximum(pairs[:, 0], pairs[:, 1])


def boxes_of(segments: Floats) -> tuple[Floats, Floats]:
    """The lowest and highest corners of the boxes around segments (S, 2, 2), as two rows, (2, S) each."""
    one, two = np.ascontiguousarray(segments.transpose(1, 2, 0))
    return np.minimum(one, two), np.maximum(one, two)


def meets(low: Floats, high: Floats, points: Floats, reach: float) -> Ints:
    """Numbers of the boxes (2, S) that come within ``reach`` of the box around some points (P, 2)."""
    first, last = points.min(axis=0) - reach, points.max(axis=0) + reach
    near = (low[0] <= last[0]) & (high[0] >= first[0]) & (low[1] <= last[1]) & (high[1] >= first[1])
    return near.nonzero()[0]
