"""What the real-versus-generated classifiers look at: a fixed list of features per object, per pair and per scene.

The list is part of the benchmark: changing it makes numbers incomparable, so it
has a version of its own. Lengths are metres, angles radians; each feature is
plain (categories, counts), a length or an angle, which decides about its noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry.arrays import Floats, Ints
from ..geometry.planar import rectangle_gap, rotate, wrapped
from ..geometry.polygon import next_corners, to_edges
from ..scene import SceneGraph
from ..scene.categories import FLOOR, category_numbers
from ..spatial import find_supports
from ..spatial.floor_plan import room_outline
from ..spatial.supports import levels_of
from .scene_validity import counted_objects

VERSION = 1
SAMPLED = 5
"""Objects, and pairs, that are drawn from each scene."""

PLAIN, LENGTH, ANGLE = 0, 1, 2

OBJECT = {
    "category": PLAIN, "width": PLAIN, "depth": PLAIN, "height": PLAIN, "support category": PLAIN,
    "things on the support": PLAIN, "x on support": LENGTH, "y on support": LENGTH, "bottom over support": LENGTH,
    "turn on support": ANGLE, "distance to wall": LENGTH, "turn to wall": ANGLE, "distance to neighbour": LENGTH,
    "gap to neighbour": LENGTH, "x of neighbour": LENGTH, "y of neighbour": LENGTH, "turn of neighbour": ANGLE,
    "distance to its like": LENGTH, "x of its like": LENGTH, "y of its like": LENGTH, "turn of its like": ANGLE,
    "x from the middle thing": LENGTH, "y from the middle thing": LENGTH, "turn to the middle thing": ANGLE,
}  # fmt: skip
"""Features of one object and their kinds; the neighbour is the nearest object on the same support."""

PAIR = {
    "category": PLAIN, "other category": PLAIN, "support category": PLAIN, "width": PLAIN, "depth": PLAIN,
    "other width": PLAIN, "other depth": PLAIN, "distance": LENGTH, "gap": LENGTH, "x of other": LENGTH,
    "y of other": LENGTH, "turn of other": ANGLE, "x seen from other": LENGTH, "y seen from other": LENGTH,
}  # fmt: skip
"""Features of an object and one of its two nearest objects on the same support."""

BY_CATEGORY = (
    "distance to wall", "turn to wall", "distance to neighbour", "gap to neighbour", "x from the middle thing",
    "y from the middle thing", "distance to its like",
)  # fmt: skip
"""Features of a scene: means of these over the objects of each category, then over all objects of each level."""

LEVELS = 3
FAR = 9.0
"""What stands for a distance to something that is not there, metres."""


@dataclass(frozen=True, eq=False)
class Features:
    """Features of one scene: objects (SAMPLED or fewer, len(OBJECT)), pairs (..., len(PAIR)) and the scene (W,)."""

    objects: Floats
    pairs: Floats
    scene: Floats


@dataclass(frozen=True, eq=False)
class _Objects:
    """K objects: category, its number, number of its support (-1: none), upright box and turn."""

    category: Ints
    support: Ints
    support_category: Ints
    level: Ints
    center: Floats
    half: Floats
    yaw: Floats
    frame: Floats
    """x, y, bottom and yaw of the support."""


def scene_features(graph: SceneGraph, vocabulary: tuple[str, ...], rng: np.random.Generator) -> Features:
    """The features of a scene whose categories are numbered as in ``vocabulary``; ``rng`` draws objects and pairs."""
    rows = _objects(graph, vocabulary)
    count = len(rows.category)
    if not count:
        return Features(np.zeros((0, len(OBJECT))), np.zeros((0, len(PAIR))), np.zeros(scene_width(vocabulary)))
    walls = _to_wall(graph, rows)
    apart = _apart(rows)
    objects = _object_features(rows, walls, apart)
    first, second = _pairs_of(rows, apart[0])
    some = rng.permutation(count)[:SAMPLED]
    few = rng.permutation(len(first))[:SAMPLED]
    pairs = _pair_features(rows, first[few], second[few], apart)
    return Features(objects[some], pairs, _scene_vector(rows, objects, len(vocabulary)))


def scene_width(vocabulary: tuple[str, ...]) -> int:
    """Number of features of a scene."""
    return len(BY_CATEGORY) * (len(vocabulary) + LEVELS)


def scene_kinds(vocabulary: tuple[str, ...]) -> Ints:
    """Kinds of a scene's features, int64 (W,)."""
    return np.tile([OBJECT[name] for name in BY_CATEGORY], len(vocabulary) + LEVELS)


def _objects(graph: SceneGraph, vocabulary: tuple[str, ...]) -> _Objects:
    codes = category_numbers(graph, vocabulary)
    rows = np.flatnonzero(counted_objects(graph) & (codes >= 0))
    supports = find_supports(graph)
    boxes, yaw = supports.objects.oriented, supports.objects.yaw
    frame = np.column_stack([boxes.center[:, :2], boxes.center[:, 2] - boxes.half[:, 2], yaw])
    chosen = supports.objects.of_row[rows]
    on, level = supports.first[chosen], levels_of(supports.first)[chosen]
    category = codes[supports.objects.rows]
    return _Objects(
        codes[rows], on, np.where(on >= 0, category[on], -1), level, boxes.center[chosen], boxes.half[chosen],
        yaw[chosen], np.where((on >= 0)[:, None], frame[on], 0.0),
    )  # fmt: skip


def _to_wall(graph: SceneGraph, rows: _Objects) -> Floats:
    """Distance of each centre to the nearest edge of the room, and the turn against that edge, (K, 2)."""
    if FLOOR not in graph.vocabulary:
        return np.tile([FAR, 0.0], (len(rows.category), 1))
    outline = room_outline(graph)
    distance = np.linalg.norm(to_edges(outline, rows.center[:, :2]), axis=-1)
    edge = (next_corners(outline) - outline)[distance.argmin(axis=1)]
    return np.column_stack([distance.min(axis=1), wrapped(rows.yaw - np.arctan2(edge[:, 1], edge[:, 0]))])


def _apart(rows: _Objects) -> tuple[Floats, Floats, Floats]:
    """Of all pairs: horizontal distance, gap of footprints, and offset of j in the frame of i (K, K, 2)."""
    offset = rows.center[None, :, :2] - rows.center[:, None, :2]
    gap = rectangle_gap(offset, rows.yaw[:, None], rows.half[:, None], rows.yaw[None], rows.half[None])
    return np.linalg.norm(offset, axis=-1), gap, rotate(offset, -rows.yaw[:, None])


def _object_features(rows: _Objects, walls: Floats, apart: tuple[Floats, ...]) -> NDArray:
    distance, gap, seen = apart
    count, each = len(rows.category), np.arange(len(rows.category))
    same_support = (rows.support[:, None] == rows.support) & ~np.eye(count, dtype=bool)
    alike = (rows.category[:, None] == rows.category) & ~np.eye(count, dtype=bool)
    columns = {
        "category": rows.category, "width": rows.half[:, 0], "depth": rows.half[:, 1],
        "height": rows.half[:, 2], "support category": rows.support_category,
        "things on the support": same_support.sum(axis=1) + 1,
        **dict(zip(("x on support", "y on support"), _in_frame(rows.center[:, :2], rows.frame).T, strict=True)),
        "bottom over support": rows.center[:, 2] - rows.half[:, 2] - rows.frame[:, 2],
        "turn on support": wrapped(rows.yaw - rows.frame[:, 3]),
        "distance to wall": walls[:, 0], "turn to wall": walls[:, 1],
    }  # fmt: skip
    for name, mask in (("neighbour", same_support), ("its like", alike)):
        there = mask.any(axis=1)
        other = np.where(mask, distance, np.inf).argmin(axis=1)
        columns[f"distance to {name}"] = np.where(there, distance[each, other], FAR)
        columns[f"gap to {name}"] = np.where(there, gap[each, other], FAR)
        columns[f"x of {name}"] = np.where(there, seen[each, other, 0], FAR)
        columns[f"y of {name}"] = np.where(there, seen[each, other, 1], FAR)
        columns[f"turn of {name}"] = np.where(there, wrapped(rows.yaw[other] - rows.yaw), 0.0)
    middle = _middle_object(rows)
    columns["x from the middle thing"], columns["y from the middle thing"] = seen[middle].T
    columns["turn to the middle thing"] = wrapped(rows.yaw - rows.yaw[middle])
    return np.column_stack([columns[name] for name in OBJECT])


def _middle_object(rows: _Objects) -> int:
    """The largest footprint within a metre of what lies most central of what stands on the floor."""
    low = np.flatnonzero(rows.level == rows.level.min())
    middle = (rows.center[low, :2].min(axis=0) + rows.center[low, :2].max(axis=0)) / 2
    far = np.linalg.norm(rows.center[low, :2] - middle, axis=1)
    near = low[far <= far.min() + 1.0]
    return int(near[(rows.half[near, 0] * rows.half[near, 1]).argmax()])


def _in_frame(points: Floats, frame: Floats) -> Floats:
    return rotate(points - frame[:, :2], -frame[:, 3])


def _pairs_of(rows: _Objects, distance: Floats) -> tuple[Ints, Ints]:
    """Each object with its two nearest on the same support."""
    same = (rows.support[:, None] == rows.support) & ~np.eye(len(distance), dtype=bool)
    order = np.where(same, distance, np.inf).argsort(axis=1, kind="stable")[:, :2]
    first = np.repeat(np.arange(len(order)), order.shape[1])
    second = order.reshape(-1)
    real = same[first, second]
    return first[real], second[real]


def _pair_features(rows: _Objects, first: Ints, second: Ints, apart: tuple[Floats, ...]) -> Floats:
    distance, gap, seen = apart
    columns = [
        rows.category[first], rows.category[second], rows.support_category[first], *rows.half[first, :2].T,
        *rows.half[second, :2].T, distance[first, second], gap[first, second], *seen[first, second].T,
        wrapped(rows.yaw[second] - rows.yaw[first]), *seen[second, first].T,
    ]  # fmt: skip
    return np.column_stack(columns)


def _scene_vector(rows: _Objects, objects: Floats, categories: int) -> Floats:
    places = [list(OBJECT).index(name) for name in BY_CATEGORY]
    values = objects[:, places]
    turn = BY_CATEGORY.index("turn to wall")
    values[:, turn] = np.abs(values[:, turn])  # headings of -180 and 180 degrees are one
    level = np.minimum(rows.level - rows.level.min(), LEVELS - 1)
    groups = np.concatenate([rows.category, categories + level])
    total, count = np.zeros((categories + LEVELS, len(places))), np.bincount(groups, minlength=categories + LEVELS)
    np.add.at(total, groups, np.concatenate([values, values]))
    mean = total / np.maximum(count, 1)[:, None]
    mean[count == 0] = -FAR
    return mean.reshape(-1)
