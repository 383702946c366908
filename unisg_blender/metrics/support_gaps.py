"""How far off its support each object is."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Bools, Floats, Ints
from ..geometry.box_overlap import nearby_pairs, penetration
from ..geometry.boxes import Boxes, part_bottoms, part_tops, reach
from ..geometry.planar import rotation
from ..scene.graph import SceneGraph
from ..spatial.part_boxes import PartBoxes
from ..spatial.supports import Supports, find_supports

_FOOT = 0.02
"""Parts whose bottom is no more than this above the lowest one are what an object stands on, metres."""


def support_gaps(graph: SceneGraph, rows: Bools | None = None, supports: Supports | None = None) -> Floats:
    """How far each object floats above (positive) or is sunk into (negative) what holds it, float64 (N,) metres.

    gap = (lowest point of the object) - (top of that part of its support, among those
    which lie under or in its feet as seen from above, whose top is nearest). It is
    infinite where nothing of the support lies under it. The support is found by
    :func:`~..spatial.supports.find_supports`; where there is none, it is everything else in the scene. Of
    several the nearest counts. For what hangs, the gap is the distance to its support (a lower bound by separating
    axes), never negative. NaN for rows that are not asked for, have no geometry, or are only parts of an object.

    Parameters
    ----------
    graph
        The scene.
    rows
        bool (N,): whom to measure; all when omitted.
    supports
        What holds what, if it is known.
    """
    supports = find_supports(graph) if supports is None else supports
    objects, boxes, count = supports.objects, supports.objects.parts, len(supports.objects)
    asked = np.ones(count, bool) if rows is None else rows[objects.rows]
    asked = asked & np.isin(np.arange(count), boxes.owner)
    gaps = np.where(asked, np.inf, np.nan)
    low, high = part_bottoms(boxes.boxes), part_tops(boxes.boxes)
    bottom = np.full(count, np.inf)
    np.minimum.at(bottom, boxes.owner, low)
    feet = low <= bottom[boxes.owner] + _FOOT
    wanted = asked[supports.subject]
    stands, hangs = wanted & ~supports.hangs, wanted & supports.hangs
    first, second = _parts_of_pairs(boxes, count, supports.subject[stands], supports.target[stands])
    loose = np.setdiff1d(np.flatnonzero(asked), supports.subject)
    if len(loose):
        under = _parts_on_common_ground(boxes, loose)
        first, second = np.concatenate([first, under[0]]), np.concatenate([second, under[1]])
    _nearest_top(gaps, boxes, bottom, high, first[feet[first]], second[feet[first]])
    first, second = _parts_of_pairs(boxes, count, supports.subject[hangs], supports.target[hangs])
    apart = np.maximum(-penetration(boxes.boxes.take(first), boxes.boxes.take(second)), 0.0)
    np.minimum.at(gaps, boxes.owner[first], apart)
    result = np.full(len(graph), np.nan)
    result[objects.rows] = gaps
    return result


def _parts_of_pairs(boxes: PartBoxes, count: int, rows: Ints, on: Ints) -> tuple[Ints, Ints]:
    """All pairs (part of a row, part of what it is on) for pairs of ``count`` rows."""
    start, stop = (np.searchsorted(boxes.owner, np.arange(count), side) for side in ("left", "right"))
    sizes = stop - start
    number = sizes[rows] * sizes[on]
    pair = np.repeat(np.arange(len(rows)), number)
    place = np.arange(number.sum()) - np.repeat(np.cumsum(number) - number, number)
    width = sizes[on][pair]
    return start[rows][pair] + place // np.maximum(width, 1), start[on][pair] + place % np.maximum(width, 1)


def _parts_on_common_ground(boxes: PartBoxes, rows: Ints) -> tuple[Ints, Ints]:
    """All pairs (part of one of the rows, part of another entity) that may share ground seen from above."""
    pairs = nearby_pairs(_columns(boxes.boxes))
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    owners = boxes.owner[pairs]
    pairs = pairs[np.isin(owners[:, 0], rows) & (owners[:, 0] != owners[:, 1])]
    return pairs[:, 0], pairs[:, 1]


def _nearest_top(
    gaps: Floats, boxes: PartBoxes, bottom: Floats, high: Floats,
    first: Ints, second: Ints,
) -> None:  # fmt: skip
    """Enter, for each owner of ``first``, the gap to that top of ``second`` under it which is nearest."""
    ground = _columns(boxes.boxes)
    under = penetration(ground.take(first), ground.take(second)) > 1e-6
    first, second = first[under], second[under]
    rows = boxes.owner[first]
    gap = bottom[rows] - high[second]
    order = np.lexsort((gap, np.abs(gap), rows))
    rows, place = np.unique(rows[order], return_index=True)
    gaps[rows] = gap[order][place]


def _columns(boxes: Boxes) -> Boxes:
    """The boxes as columns without end: what overlaps here shares ground as seen from above."""
    level = np.argmax(np.linalg.norm(boxes.axes[:, :2], axis=1), axis=1)
    along = boxes.axes[np.arange(len(level)), :2, level]
    axes = rotation(np.arctan2(along[:, 1], along[:, 0]))
    half = reach(Boxes(boxes.center, np.swapaxes(axes, 1, 2) @ boxes.axes, boxes.half, boxes.solid))
    half[:, 2] = 1e3
    return Boxes(boxes.center * (1.0, 1.0, 0.0), axes, half, boxes.solid)
