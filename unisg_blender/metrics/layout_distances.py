"""Are generated rooms new, and do they differ: distances between layouts.

The distance of room A from room B is the mean, over the objects of A, of the
horizontal distance to the nearest object of the same category in B, metres, at
most 1 m each; rooms lie over each other with the middles of their outlines, in
that of four quarter turns which is nearest.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..geometry.arrays import Floats
from ..scene import SceneGraph
from ..scene.categories import FLOOR, category_numbers
from ..spatial import find_objects
from ..spatial.floor_plan import room_outline
from .scene_validity import counted_objects

CAP = 1.0
FAR_OFF = 1e4
"""Metres at which objects are that a room does not have: farther than any cap."""

COPIED = 0.05
"""Share of real unseen rooms that lie nearer to a training room than the limit of novelty."""

_TURNS = np.array([[[1, 0], [0, 1]], [[0, -1], [1, 0]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]]], np.float32)


class LayoutSet:
    """Many layouts, by category: positions float32 (2, S, most), very far away where there is none."""

    def __init__(self, layouts: Sequence[NDArray[np.float32]], categories: int) -> None:
        counts = np.array([np.bincount(room[:, 0].astype(np.int64), minlength=categories) for room in layouts])
        most = counts.max(axis=0, initial=0) if len(layouts) else np.zeros(categories, np.int64)
        self.places = [np.full((2, len(layouts), int(number)), FAR_OFF, np.float32) for number in most]
        for number, room in enumerate(layouts):
            for category in np.unique(room[:, 0].astype(np.int64)):
                mine = room[room[:, 0] == category, 1:]
                self.places[category][:, number, : len(mine)] = mine.T

    def distances(self, layout: NDArray[np.float32]) -> Floats:
        """How far a layout is from each room, (S,) metres."""
        rooms = self.places[0].shape[1]
        if not len(layout):
            return np.full(rooms, np.nan)
        total = np.zeros((4, rooms))
        for category in np.unique(layout[:, 0].astype(np.int64)):
            mine = np.einsum("tij,kj->tki", _TURNS, layout[layout[:, 0] == category, 1:])
            x, y = self.places[category]
            if not x.shape[1]:
                total += CAP * mine.shape[1]
                continue
            for turn in range(4):
                for left, up in mine[turn]:
                    nearest = np.square(x - left) + np.square(y - up)
                    total[turn] += np.minimum(np.sqrt(nearest.min(axis=1)), CAP)
        return total.min(axis=0) / len(layout)


def layout_of(graph: SceneGraph, vocabulary: tuple[str, ...]) -> NDArray[np.float32]:
    """The objects of a scene: number of the category, x and y from the middle of the room, float32 (K, 3)."""
    codes = category_numbers(graph, vocabulary)
    rows = np.flatnonzero(counted_objects(graph) & (codes >= 0))
    objects = find_objects(graph, empty=False)
    center = objects.oriented.center[objects.of_row[rows], :2]
    middle = np.zeros(2)
    if FLOOR in graph.vocabulary:
        outline = room_outline(graph)
        middle = (outline.min(axis=0) + outline.max(axis=0)) / 2
    return np.column_stack([codes[rows], center - middle]).astype(np.float32)


def nearest_room_distances(layouts: Sequence[NDArray[np.float32]], training: LayoutSet) -> Floats:
    """How far each layout is from the training room that is nearest to it, (S,) metres."""
    return np.array([training.distances(layout).min() for layout in layouts])


def novelty_limit(real: Floats) -> float:
    """Distance from the nearest training room beyond which a room counts as new, metres.

    All but :data:`COPIED` of the unseen real rooms, whose distances are given, are beyond it.
    """
    return float(np.quantile(real, COPIED))


def mean_pairwise(layouts: Sequence[NDArray[np.float32]], categories: int, most: int = 100) -> float:
    """Mean distance between two of the layouts (of the first ``most``), metres: how much they differ.

    Divided by that of real rooms it is the diversity ratio: under 1 for rooms that
    are too alike, 1 for rooms that differ as real ones do.
    """
    some = [layout for layout in layouts if len(layout)][:most]
    rooms = LayoutSet(some, categories)
    table = np.array([rooms.distances(layout) for layout in some])
    return float(table[~np.eye(len(some), dtype=bool)].mean())
