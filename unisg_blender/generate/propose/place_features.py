"""What the trees see of a place that is tried: walls, neighbours, support, clearance; one row of numbers for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.planar import rotate, turned_reach, wrapped
from ..observe.observed_scene import ObservedScene
from ..observe.prior_tables import PriorTables
from .plain_proposals import TriedRoom
from .proposer import Proposals

FAR = 10.0
"""Metres that stand for "nowhere near", and beyond which nothing counts."""

STEP = 0.1
"""Metres to which heights are told."""

LANDMARKS = 12
"""Categories that stand on floors most often, to which distances are told."""

OWN, SIDES, ON = 5, 4, 14
"""How many numbers tell of the object, clear space, the support."""


@dataclass(frozen=True, eq=False)
class CategoryKinds:
    """What is told of C categories: ``rank`` int64 (C + 1,) in an order in which alike ones are near each other,
    ``landmarks`` (numbers), and the numbers of doors and windows (-2: none)."""

    rank: Ints
    landmarks: tuple[int, ...]
    openings: tuple[int, int]

    @staticmethod
    def of(tables: PriorTables, sizes: Mapping[str, Sequence[float]], vocabulary: Sequence[str]) -> CategoryKinds:
        """By the priors: those on floors first, by size; the landmarks are the commonest of them."""
        count = len(vocabulary)
        floor_share, total = np.zeros(count), np.zeros(count)
        for category, supports in tables.supports.items():
            for number, prior in supports.items():
                total[category] += prior.count
                floor_share[category] += prior.count * (number < 0 or bool(tables.structural[number]))
        share = floor_share / np.maximum(total, 1)
        volume = np.array([np.prod(sizes.get(name, (0, 0, 0))) for name in vocabulary])
        order = np.lexsort((-volume, -share.round(1)))
        rank = np.empty(count + 1, np.int64)
        rank[order], rank[-1] = np.arange(count), count
        common = [c for c in np.argsort(-floor_share, kind="stable") if not tables.structural[c] and share[c] > 0.5]
        names = list(vocabulary)
        openings = tuple(names.index(name) if name in names else -2 for name in ("Door", "Window"))
        return CategoryKinds(rank, tuple(int(c) for c in common[:LANDMARKS]), (openings[0], openings[1]))


def place_features(
    room: TriedRoom, kinds: CategoryKinds, category: int, half: Floats, proposals: Proposals
) -> NDArray[np.float32]:
    """The features (T, F) of places for an object of a category with half extents (3,)."""
    scene, places, support = room.scene, proposals.places, proposals.support
    others = np.flatnonzero(room.seen & ~(room.structural & ~np.isin(scene.category, kinds.openings)))
    near = _Near.of(scene, others, places, half)
    own = np.empty((len(places), OWN))
    own[:, 0], own[:, 1:4], own[:, 4] = kinds.rank[category], half, _coarse(places[:, 2] - scene.room.ground)
    gap, normal = room.walls.gaps(places, half)
    parts = [own, _walls(places, gap, normal), _sides(near, half, gap, normal, places)]
    parts += [_met(scene, near, kinds, category, support), _on(room, kinds, category, half, places, support)]
    parts += [_nearest(room, near, kinds, places, support), _landmarks(scene, near, kinds)]
    return np.concatenate(parts, axis=1).clip(-FAR, 1e3).astype(np.float32)


def _coarse(height: Floats) -> Floats:
    """Heights to :data:`STEP`: a true place is not told by the millimetres by which things stand above one another."""
    return np.asarray(np.round(height / STEP) * STEP)


@dataclass(frozen=True, eq=False)
class _Near:
    """Other objects (K,) as T places see them: offsets in the places' frames and the reach of the others there
    (T, K, 2), clearances and distances (T, K), and which are as high, bool (T, K)."""

    obj: Ints
    local: Floats
    reach: Floats
    gap: Floats
    distance: Floats
    level: Bools

    @staticmethod
    def of(scene: ObservedScene, obj: Ints, places: Floats, half: Floats) -> _Near:
        """Objects (K,) of a scene seen from places (T, 4) of a thing with half extents (3,)."""
        offset = scene.center[obj, :2] - places[:, None, :2]
        local = rotate(offset, -places[:, 3:])
        turn = scene.yaw[obj] - places[:, 3:]
        reach = turned_reach(scene.half[obj, :2], turn)
        mine = (np.abs(local) - half[:2] - reach).max(axis=2)
        theirs = np.abs(rotate(offset, -scene.yaw[obj])) - scene.half[obj, :2] - turned_reach(half[:2], turn)
        low, high = scene.center[obj, 2] - scene.half[obj, 2], scene.center[obj, 2] + scene.half[obj, 2]
        level = (low < places[:, 2:3] + 2 * half[2] - 0.005) & (high > places[:, 2:3] + 0.005)
        gap = np.maximum(mine, theirs.max(axis=2))
        return _Near(obj, local, reach, gap, np.hypot(local[..., 0], local[..., 1]), level)


def _least(values: Floats, where: Bools) -> Floats:
    """The least of values (T, K) where something holds, :data:`FAR` at most."""
    return np.asarray(np.where(where, values, FAR).min(axis=1, initial=FAR))


def _walls(places: Floats, gap: Floats, normal: Floats) -> Floats:
    """Clearance and turn against the normal of the two nearest walls: cosine and sine."""
    found = np.tile([FAR, 0.0, 0.0], (len(places), 2))
    order, rows = np.argsort(gap, axis=1)[:, :2], np.arange(len(places))
    for number in range(order.shape[1]):
        wall = order[:, number]
        turn = places[:, 3] - normal[rows, wall]
        found[:, 3 * number : 3 * number + 3] = np.column_stack([gap[rows, wall], np.cos(turn), np.sin(turn)])
    return found


def _sides(near: _Near, half: Floats, gap: Floats, normal: Floats, places: Floats) -> Floats:
    """Clear space ahead, behind, left and right of the object: to what is as high, or to a wall that faces it."""
    found, beyond = np.full((len(places), SIDES), FAR), np.abs(near.local) - near.reach - half[:2]
    turn = normal - places[:, 3:]
    for side, (axis, sign) in enumerate(((1, 1), (1, -1), (0, 1), (0, -1))):
        ahead = near.level & (near.local[..., axis] * sign > 0) & (beyond[..., 1 - axis] < 0)
        facing = -sign * (np.sin(turn) if axis == 1 else np.cos(turn))  # the normal looks back at the object
        found[:, side] = np.minimum(_least(beyond[..., axis], ahead), _least(gap, facing > 0.9))
    return found


def _met(scene: ObservedScene, near: _Near, kinds: CategoryKinds, category: int, support: Ints) -> Floats:
    """The least clearance to what is as high; the nearest of its own category; of doors and windows; how crowded."""
    other = near.level & (near.obj != support[:, None])
    kind = scene.category[near.obj]
    alike = np.broadcast_to(kind == category, near.gap.shape)
    found = [_least(near.gap, other), _least(near.distance, alike), _least(near.gap, alike)]
    found += [_least(near.gap, np.broadcast_to(kind == opening, near.gap.shape)) for opening in kinds.openings]
    return np.column_stack([*found, (other & (near.gap < 1)).sum(axis=1)])


def _on(room: TriedRoom, kinds: CategoryKinds, category: int, half: Floats, places: Floats, support: Ints) -> Floats:
    """What it is on, where on it, how far from its edges, how full that is."""
    scene, found = room.scene, np.full((len(places), ON), -1.0)
    for obj in np.unique(support[support >= 0]):
        rows = np.flatnonzero(support == obj)
        offset = rotate(places[rows, :2] - scene.center[obj, :2], -scene.yaw[obj])
        size, turn = scene.half[obj, :2], places[rows, 3] - scene.yaw[obj]
        held = np.flatnonzero(room.seen & (scene.support == obj) & ~room.structural)
        area = 4 * size.prod() + 1e-6
        edge = size - np.abs(offset) - turned_reach(half[:2], turn)
        found[rows, 0], found[rows, 1] = (
            kinds.rank[scene.category[obj]],
            _coarse(places[rows, 2] - scene.center[obj, 2]),
        )
        found[rows, 4], found[rows, 5] = edge.min(axis=1), edge.max(axis=1)
        found[rows, 2:4], found[rows, 8:10] = offset / np.maximum(size, 1e-3), size
        found[rows, 6], found[rows, 7] = np.cos(turn), np.sin(turn)
        found[rows, 10] = (4 * scene.half[held, :2].prod(axis=1)).sum() / area
        found[rows, 11], found[rows, 12] = len(held), (scene.category[held] == category).sum()
        found[rows, 13] = _coarse(scene.center[obj, 2] + scene.half[obj, 2] - places[rows, 2])
    return found


def _nearest(room: TriedRoom, near: _Near, kinds: CategoryKinds, places: Floats, support: Ints) -> Floats:
    """The nearest neighbour that is no support of it: its category, where the object is as that one sees it, turn."""
    scene, found = room.scene, np.tile([-1.0, FAR, FAR, 0.0, 0.0], (len(places), 1))
    other = (near.obj != support[:, None]) & ~room.structural[near.obj]
    if not len(near.obj):
        return found
    gap = np.where(other, near.gap + ~near.level, FAR)
    best, rows = gap.argmin(axis=1), np.arange(len(places))
    there = gap[rows, best] < FAR
    obj = near.obj[best]
    seen = rotate(places[:, :2] - scene.center[obj, :2], -scene.yaw[obj])
    turn = wrapped(places[:, 3] - scene.yaw[obj])
    bearing = near.local[rows, best, 1] / np.maximum(near.distance[rows, best], 1e-6)
    told = np.column_stack([kinds.rank[scene.category[obj]], np.abs(seen[:, 0]), seen[:, 1], np.cos(turn), bearing])
    found[there] = told[there]
    return found


def _landmarks(scene: ObservedScene, near: _Near, kinds: CategoryKinds) -> Floats:
    """To the nearest of each landmark: by centre, and clearance."""
    found, kind = np.full((len(near.gap), 2 * LANDMARKS), FAR), scene.category[near.obj]
    for number, landmark in enumerate(kinds.landmarks):
        mine = kind == landmark
        if mine.any():
            found[:, 2 * number] = near.distance[:, mine].min(axis=1).clip(max=FAR)
            found[:, 2 * number + 1] = near.gap[:, mine].min(axis=1).clip(max=FAR)
    return found
