"""Candidates: what the choice of a support is made among, every surface of every object and "elsewhere on it"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.planar import outside_rectangle
from .observed_scene import ObservedScene
from .scene_tokens import TINY, Arrays

OCCUPANCY_WIDTH = 14

NEARBY = 1.0
"""Metres over which it counts less by a factor of e that something stands near a support."""


@dataclass(frozen=True, eq=False)
class SupportCandidates:
    """N candidates of some objects, those of one object together: its surfaces from below, then elsewhere on it.

    Attributes
    ----------
    obj, surface
        int64 (N,): the object, and which of its surfaces; -1 for elsewhere (hanging, at the side, within).
    measures
        (N, 4): height above the object's bottom, area, headroom (metres), and the surface's place among them in 0..1.
    first
        int64 (K,): the first candidate of each object, -1 for objects that have none.
    """

    obj: Ints
    surface: Ints
    measures: Floats
    first: Ints

    @staticmethod
    def of(scene: ObservedScene, objects: Sequence[int] | Ints) -> SupportCandidates:
        """The candidates of some objects of a scene."""
        objects = np.asarray(objects, np.int64)
        surfaces = [scene.surfaces(number) for number in objects.tolist()]
        count = np.array([len(found) for found in surfaces], np.int64)
        elsewhere = np.cumsum(count + 1) - 1
        first = np.full(len(scene.category), -1, np.int64)
        first[objects] = elsewhere - count
        obj = np.repeat(objects, count + 1)
        surface = np.arange(len(obj)) - first[obj]
        level = np.ones(len(obj), bool)
        level[elsewhere] = False
        measures, half = np.zeros((len(obj), 4)), scene.half[objects]
        measures[level, :3] = np.concatenate([np.zeros((0, 3)), *surfaces])
        measures[level, 3] = surface[level] / np.repeat(np.maximum(count - 1, 1), count)
        measures[elsewhere, 1], measures[elsewhere, 2] = 4 * half[:, 0] * half[:, 1], 2 * half[:, 2]
        surface[elsewhere] = -1
        return SupportCandidates(obj, surface, measures, first)

    def at(self, obj: Ints, surface: Ints) -> Ints:
        """Numbers of the candidates for objects int64 (T,) (-1: none) and surfaces (T,), -1 for none."""
        count = np.bincount(self.obj, minlength=len(self.first))
        number = self.first[obj] + np.where(surface >= 0, surface, count[obj] - 1)
        return np.where((obj >= 0) & (self.first[obj] >= 0), number, -1)


@dataclass(frozen=True, eq=False)
class SupportOccupancy:
    """What lies where, T objects: support and surface int64 (T,), category (T,), footprint (T,) in m2."""

    support: Ints
    surface: Ints
    category: Ints
    area: Floats

    @staticmethod
    def of(scene: ObservedScene, seen: Bools | bool = True) -> SupportOccupancy:
        """Of the objects of a scene that are there, bool (K,): all if omitted."""
        held = np.flatnonzero(seen & (scene.support >= 0))
        area = 4 * scene.half[held, 0] * scene.half[held, 1]
        return SupportOccupancy(scene.support[held], scene.surface[held], scene.category[held], area)

    def with_object(self, support: int, surface: int, category: int, area: float) -> SupportOccupancy:
        """The same with one object more."""
        return SupportOccupancy(
            np.append(self.support, support), np.append(self.surface, surface), np.append(self.category, category),
            np.append(self.area, area),
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Proximity:
    """How near to each of K objects those J objects are that stand on a root: ``share`` (K, J) is 1 where they touch.

    ``obj`` int64 (J,) are their numbers, by category.
    """

    obj: Ints
    share: NDArray[np.float32]

    @staticmethod
    def of(scene: ObservedScene) -> Proximity:
        """Of a scene."""
        held = np.flatnonzero(scene.support >= 0)
        obj = held[scene.support[scene.support[held]] < 0]
        obj = obj[np.argsort(scene.category[obj], kind="stable")]
        offset = scene.center[obj, None, :2] - scene.center[:, :2]
        here = outside_rectangle(offset, scene.yaw, scene.half[:, :2])
        there = outside_rectangle(offset, scene.yaw[obj, None], scene.half[obj, None, :2])
        share = np.exp(-np.minimum(here, there) / NEARBY)
        share[np.arange(len(obj)), obj] = 0
        return Proximity(obj, share.T.astype(np.float32))

    def by_kind(self, scene: ObservedScene, seen: Bools, unknown: int) -> NDArray[np.float32]:
        """The nearest of each category that is there, bool (K,), to each object: (K, C + 1)."""
        result = np.zeros((len(self.share), unknown + 1), np.float32)
        there = seen[self.obj]
        kind = scene.category[self.obj[there]]
        if len(kind):
            starts = np.flatnonzero(np.diff(kind, prepend=kind[0] - 1))
            number = np.where(kind[starts] < 0, unknown, kind[starts])
            result[:, number] = np.maximum.reduceat(self.share[:, there], starts, axis=1)
        return result


def support_arrays(
    scene: ObservedScene, candidates: SupportCandidates, load: SupportOccupancy, near: NDArray[np.float32],
    category: int, half: Floats, unknown: int,
) -> Arrays:  # fmt: skip
    """Inputs for choosing among candidates (N,) for a target of half extents (3,): what they are, lies there, is near.

    ``near`` (K, C + 1) is what :meth:`Proximity.by_kind` says.
    """
    count, objects = len(candidates.obj), len(scene.category)
    candidate = candidates.at(load.support, load.surface)
    on = candidate >= 0
    candidate, kind, area = candidate[on], load.category[on], load.area[on]
    content = np.zeros((count, unknown + 1), np.float32)
    np.add.at(content, (candidate, np.where(kind < 0, unknown, kind)), 1)
    covered = np.bincount(candidate, weights=area, minlength=count)
    mine = np.bincount(load.support[load.category == category], minlength=objects)[candidates.obj]
    everything = np.bincount(load.support, minlength=objects)[candidates.obj]
    height, area, headroom, rank = candidates.measures.T
    footprint = 4 * half[0] * half[1] + TINY
    own = scene.half[candidates.obj]
    narrow, long = np.sort(own[:, :2], axis=1).T
    slim, wide = sorted(half[:2])
    features = np.empty((OCCUPANCY_WIDTH, count), np.float32)
    features[:4] = np.log1p([content[:, category], content.sum(axis=1), mine, everything])
    features[4:6] = np.minimum(np.stack([covered, covered + footprint]) / np.maximum(area, TINY), 2)
    features[6:9] = candidates.surface < 0, height, np.log(area + TINY) / 4
    features[9:11] = headroom.clip(0, 1), np.tanh(4 * (headroom - 2 * half[2]))
    features[11:] = rank, scene.room.level[candidates.obj] / 4, np.tanh(4 * np.minimum(narrow - slim, long - wide))
    kinds = np.append(np.where(scene.category < 0, unknown, scene.category), unknown)
    return {
        "support_category": kinds[candidates.obj].astype(np.int64),
        "support_holder": kinds[scene.support[candidates.obj]].astype(np.int64),
        "support_half": own.astype(np.float32),
        "support_load": features.T,
        "support_content": np.log1p(content),
        "support_near": near[candidates.obj],
    }
