"""Rooms as geometry alone, for networks that are told no names: boxes, who is near whom, and what is true of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.boxes import Boxes
from ...geometry.planar import rotation
from ...predict.object_pairs import box_poses
from ...runtime.atomic_files import replacing
from ...scene import SceneGraph
from ...scene.categories import STRUCTURE, has_category
from ...scene.components import ACTIONS
from ...spatial import find_objects
from ..paper.pairs import true_edges

NEAREST = 8
"""Others that each object sees: those whose boxes are nearest to its middle."""

DISPLACED = 0.25
"""Share of the objects that stand elsewhere in a room of which some were moved, see :func:`displaced`."""

METRES, RISE, RADIANS = 0.4, 0.05, 0.6
"""Standard deviations of how far those are moved along the floor and up or down, and turned."""


@dataclass(frozen=True, eq=False)
class RoomArrays:
    """Some rooms one after another; the rows of room k are ``start[k]`` to ``start[k + 1]``.

    ``pose`` (N, 4, 4) of the boxes' middles, ``half`` (N, 3), ``near`` int64 (N, NEAREST), rows within the room,
    ``seen`` bool, whether there is such a neighbour; ``on`` bool, whether the object stands on it; ``acts`` bool (N,),
    whether something is to be done with it; ``moved`` bool (N,); ``kind`` int64 (K,), the kind of each room; ``missed``
    int64 (K,), the objects whose support is none of their neighbours.
    """

    start: Ints
    pose: NDArray[np.float64]
    half: Floats
    near: Ints
    seen: Bools
    on: Bools
    acts: Bools
    moved: Bools
    kind: Ints
    missed: Ints

    def __len__(self) -> int:
        return len(self.kind)

    def save(self, path: Path) -> None:
        """Write to a file, whole or not at all; :meth:`load` reads it."""
        with replacing(path) as draft, draft.open("wb") as file:
            np.savez(file, **{field.name: getattr(self, field.name) for field in fields(self)})

    @staticmethod
    def load(path: Path) -> RoomArrays:
        """What :meth:`save` wrote."""
        with np.load(path, allow_pickle=False) as arrays:
            return RoomArrays(**dict(arrays))

    def take(self, rooms: Sequence[int] | Ints) -> RoomArrays:
        """Some of the rooms, in the order given."""
        rooms = np.asarray(rooms, np.int64)
        rows = np.concatenate([np.arange(self.start[room], self.start[room + 1]) for room in rooms])
        start = np.concatenate([[0], np.cumsum(np.diff(self.start)[rooms])])
        parts = {name: getattr(self, name)[rows] for name in ("pose", "half", "near", "seen", "on", "acts", "moved")}
        return RoomArrays(start=start, kind=self.kind[rooms], missed=self.missed[rooms], **parts)

    def turned(self, angles: Floats) -> RoomArrays:
        """Each room turned about the vertical by an angle (K,), radians."""
        turn = np.tile(np.eye(4), (len(self), 1, 1))
        turn[:, :3, :3] = rotation(angles)
        each = np.repeat(turn, np.diff(self.start), axis=0)
        changed = {field.name: getattr(self, field.name) for field in fields(self)} | {"pose": each @ self.pose}
        return RoomArrays(**changed)


def joined(parts: Sequence[RoomArrays]) -> RoomArrays:
    """Rooms one after another."""
    counts = np.concatenate([np.diff(part.start) for part in parts])
    names = [field.name for field in fields(RoomArrays) if field.name != "start"]
    columns = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return RoomArrays(start=np.concatenate([[0], np.cumsum(counts)]), **columns)


def room_arrays(graph: SceneGraph, kind: int, rng: np.random.Generator | None = None) -> RoomArrays | None:
    """One room of a kind; with ``rng`` some of its objects are moved. None if there are less than two objects in it."""
    objects = find_objects(graph, empty=False)
    kept = np.flatnonzero(~has_category(graph, STRUCTURE)[objects.rows])
    if len(kept) < 2:
        return None
    rows, boxes, moved = objects.rows[kept], objects.oriented.take(kept), np.zeros(len(kept), bool)
    if rng is not None:
        boxes, moved = displaced(boxes, rng)
    near, seen = nearest_boxes(boxes, NEAREST)
    place = {int(row): number for number, row in enumerate(rows)}
    edges = {(place[one], place[two]) for one, two in true_edges(graph) if one in place and two in place}
    on = np.array([[(one, int(two)) in edges for two in others] for one, others in enumerate(near)]) & seen
    acts = graph.components.get(ACTIONS)
    return RoomArrays(
        np.array([0, len(kept)]), box_poses(boxes), boxes.half, near, seen, on,
        np.isin(rows, [] if acts is None else acts.rows), moved, np.array([kind]),
        np.array([len(edges) - int(on.sum())]),
    )  # fmt: skip


def displaced(boxes: Boxes, rng: np.random.Generator) -> tuple[Boxes, Bools]:
    """The boxes with a share of them moved and turned about the vertical, and which; one at least."""
    count = len(boxes.half)
    moved = rng.random(count) < DISPLACED
    moved[rng.integers(count)] = True
    shift = rng.normal(size=(count, 3)) * (METRES, METRES, RISE) * moved[:, None]
    turn = rotation(rng.normal(0, RADIANS, count) * moved)
    return Boxes(boxes.center + shift, turn @ boxes.axes, boxes.half, boxes.solid), moved


def nearest_boxes(boxes: Boxes, count: int) -> tuple[Ints, Bools]:
    """For each box the ``count`` others nearest to its middle, int64 (N, count), and whether there are so many.

    Of boxes that its middle lies in, or is as near to, the one comes first whose own middle is nearer. No motion
    changes who is near whom.
    """
    apart = boxes.center[:, None] - boxes.center
    gap = np.maximum(np.abs(np.einsum("jba,ijb->ija", boxes.axes, apart)) - boxes.half, 0)
    distance = np.linalg.norm(gap, axis=2) + 1e-3 * np.linalg.norm(apart, axis=2)
    np.fill_diagonal(distance, np.inf)
    order = np.argsort(distance, axis=1, kind="stable")[:, :count]
    near, there = np.zeros((len(order), count), np.int64), np.zeros((len(order), count), bool)
    near[:, : order.shape[1]], there[:, : min(count, len(order) - 1)] = order, True
    return near, there
