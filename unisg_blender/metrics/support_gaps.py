"""What carries what, and how far off its support each object is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry.box_overlap import nearby_pairs, penetration
from ..geometry.boxes import Boxes
from ..scene.graph import SceneGraph
from ..spatial.part_boxes import PartBoxes, part_boxes

SUPPORT_KINDS = ("on_top_of", "inside", "hangs_from")
"""Relations to what carries an entity."""

_FOOT = 0.02
"""Parts whose bottom is no more than this above the lowest one are what an object stands on, metres."""


@dataclass(frozen=True, eq=False)
class Supports:
    """Which row stands on (in) or hangs from which: int64 (K,), int64 (K,), bool (K,); rows ascend and may repeat."""

    row: NDArray[np.int64]
    on: NDArray[np.int64]
    hangs: NDArray[np.bool_]


def find_supports(graph: SceneGraph) -> Supports:
    """What carries each entity: what its relations name, else its nearest ancestor with geometry.

    The relations ``on_top_of``, ``inside`` and ``hangs_from`` count; an entity may
    have several. Entities without either have no entry.
    """
    solid = (graph.mesh >= 0).tolist()
    carrier: list[int] = []
    for above in graph.parent.tolist():  # parents come first
        carrier.append(above if above < 0 or solid[above] else carrier[above])
    ancestor = np.array(carrier, np.int64)
    row, on, hangs = np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0, bool)
    relations = graph.components.get("relations")
    if relations is not None:
        kind = relations.columns["kind"].astype(str)
        target = np.array([graph.row_of_uid.get(uid, -1) for uid in relations.columns["target"]], np.int64)
        named = np.isin(kind, SUPPORT_KINDS) & (target >= 0) & (graph.mesh[target] >= 0)
        row, on, hangs = relations.rows[named].astype(np.int64), target[named], kind[named] == "hangs_from"
    rest = np.setdiff1d(np.flatnonzero(ancestor >= 0), row)
    row, on = np.concatenate([row, rest]), np.concatenate([on, ancestor[rest]])
    order = np.argsort(row, kind="stable")
    return Supports(row[order], on[order], np.concatenate([hangs, np.zeros(len(rest), bool)])[order])


def support_gaps(
    graph: SceneGraph, rows: NDArray[np.bool_] | None = None, boxes: PartBoxes | None = None
) -> NDArray[np.float64]:
    """How far each entity floats above (positive) or is sunk into (negative) what carries it, float64 (N,) metres.

    gap = (lowest point of the entity) - (top of that part of its support, among those
    which lie under or in its feet as seen from above, whose top is nearest). It is
    infinite where nothing of the support lies under it. The support is found by
    :func:`find_supports`; where there is none, it is everything else in the scene. Of
    several the nearest counts. For what hangs, the gap is the distance to its support (a lower bound by separating
    axes), never negative. NaN for rows that are not asked for or have no geometry.

    Parameters
    ----------
    graph
        The scene.
    rows
        bool (N,): whom to measure; all when omitted.
    boxes
        The scene's part boxes, if they are known.
    """
    boxes = part_boxes(graph) if boxes is None else boxes
    asked = np.ones(len(graph), bool) if rows is None else rows
    asked = asked & np.isin(np.arange(len(graph)), boxes.owner)
    found = find_supports(graph)
    gaps = np.full(len(graph), np.nan)
    gaps[asked] = np.inf
    low, high = _heights(boxes.boxes)
    bottom = np.full(len(graph), np.inf)
    np.minimum.at(bottom, boxes.owner, low)
    feet = low <= bottom[boxes.owner] + _FOOT
    wanted = asked[found.row]
    stands, hangs = wanted & ~found.hangs, wanted & found.hangs
    first, second = _parts_of_pairs(boxes, len(graph), found.row[stands], found.on[stands])
    loose = np.setdiff1d(np.flatnonzero(asked), found.row)
    if len(loose):
        under = _parts_on_common_ground(boxes, loose)
        first, second = np.concatenate([first, under[0]]), np.concatenate([second, under[1]])
    _nearest_top(gaps, boxes, bottom, high, first[feet[first]], second[feet[first]])
    first, second = _parts_of_pairs(boxes, len(graph), found.row[hangs], found.on[hangs])
    apart = np.maximum(-penetration(boxes.boxes.take(first), boxes.boxes.take(second)), 0.0)
    np.minimum.at(gaps, boxes.owner[first], apart)
    return gaps


def _heights(boxes: Boxes) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    reach = (np.abs(boxes.axes[:, 2]) * boxes.half).sum(axis=1)
    return boxes.center[:, 2] - reach, boxes.center[:, 2] + reach


def _parts_of_pairs(
    boxes: PartBoxes, count: int, rows: NDArray[np.int64], on: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """All pairs (part of a row, part of what it is on) for pairs of ``count`` rows."""
    start, stop = (np.searchsorted(boxes.owner, np.arange(count), side) for side in ("left", "right"))
    sizes = stop - start
    number = sizes[rows] * sizes[on]
    pair = np.repeat(np.arange(len(rows)), number)
    place = np.arange(number.sum()) - np.repeat(np.cumsum(number) - number, number)
    width = sizes[on][pair]
    return start[rows][pair] + place // np.maximum(width, 1), start[on][pair] + place % np.maximum(width, 1)


def _parts_on_common_ground(boxes: PartBoxes, rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """All pairs (part of one of the rows, part of another entity) that may share ground seen from above."""
    pairs = nearby_pairs(_upright(boxes.boxes))
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    owners = boxes.owner[pairs]
    pairs = pairs[np.isin(owners[:, 0], rows) & (owners[:, 0] != owners[:, 1])]
    return pairs[:, 0], pairs[:, 1]


def _nearest_top(
    gaps: NDArray[np.float64], boxes: PartBoxes, bottom: NDArray[np.float64], high: NDArray[np.float64],
    first: NDArray[np.int64], second: NDArray[np.int64],
) -> None:  # fmt: skip
    """Enter, for each owner of ``first``, the gap to that top of ``second`` under it which is nearest."""
    ground = _upright(boxes.boxes)
    under = penetration(ground.take(first), ground.take(second)) > 1e-6
    first, second = first[under], second[under]
    rows = boxes.owner[first]
    gap = bottom[rows] - high[second]
    order = np.lexsort((gap, np.abs(gap), rows))
    rows, place = np.unique(rows[order], return_index=True)
    gaps[rows] = gap[order][place]


def _upright(boxes: Boxes) -> Boxes:
    """The boxes as columns without end: what overlaps here shares ground as seen from above."""
    level = np.argmax(np.linalg.norm(boxes.axes[:, :2], axis=1), axis=1)
    along = boxes.axes[np.arange(len(level)), :2, level]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    axes = np.zeros_like(boxes.axes)
    axes[:, :2, 0], axes[:, 0, 1], axes[:, 1, 1], axes[:, 2, 2] = along, -along[:, 1], along[:, 0], 1.0
    half = np.einsum("pjk,pk->pj", np.abs(np.swapaxes(axes, 1, 2) @ boxes.axes), boxes.half)
    half[:, 2] = 1e3
    return Boxes(boxes.center * (1.0, 1.0, 0.0), axes, half, boxes.solid)
