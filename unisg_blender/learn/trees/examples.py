"""What the trees learn from: for each object of a room its true place, and plain proposals beside it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...generate.observe.observed_scene import ObservedScene
from ...generate.observe.prior_tables import PriorTables
from ...generate.observe.scene_tokens import chain
from ...generate.observe.seen_places import SeenPlaces
from ...generate.propose.place_features import CategoryKinds, place_features
from ...generate.propose.plain_proposals import TriedRoom, plain_proposals
from ...generate.propose.proposer import Proposals
from ...geometry.arrays import Bools, Ints

AGAINST = 16
"""Proposals beside each true place."""

MISSING = 1 / 6
"""Share of the other things that are left out, for rooms are completed from any state."""

Examples = tuple[NDArray[np.float32], NDArray[np.float32]]


def examples(
    scenes: Sequence[ObservedScene], places: SeenPlaces, tables: PriorTables, kinds: CategoryKinds, rounds: int,
    rng: np.random.Generator,
) -> Examples:  # fmt: skip
    """Features (N, F) and whether each is a true place (N,); proposals come from the other rooms."""
    features, true = [], []
    for number, scene in enumerate(scenes):
        others = places.without(number)
        for _ in range(rounds):
            for obj in movable(scene, tables):
                found = _example(scene, int(obj), others, tables, kinds, rng)
                features.append(found)
                true.append(np.append(1.0, np.zeros(len(found) - 1)))
    return np.concatenate(features), np.concatenate(true).astype(np.float32)


def movable(scene: ObservedScene, tables: PriorTables) -> Ints:
    """The objects that are learned from: with a category and a size, and no building."""
    return np.flatnonzero((scene.category >= 0) & ~tables.structural[scene.category] & (scene.half.max(axis=1) > 0))


def without_above(scene: ObservedScene, gone: Sequence[int]) -> Bools:
    """What is there, bool (K,), without some objects and all that stands on them."""
    there = np.ones(len(scene.category) + 1, bool)  # the last: on nothing
    there[list(gone)] = False
    for _ in range(int(scene.room.level.max(initial=0))):
        there[:-1] &= there[scene.support]
    return there[:-1]


def _example(
    scene: ObservedScene,
    obj: int,
    places: SeenPlaces,
    tables: PriorTables,
    kinds: CategoryKinds,
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    """The features of the true place, then of plain ones."""
    category, half = int(scene.category[obj]), scene.half[obj]
    missing = np.flatnonzero((rng.random(len(scene.category)) < MISSING) & ~tables.structural[scene.category])
    seen = without_above(scene, [obj, *missing[missing != scene.support[obj]]])
    for below in chain(scene.support, obj):
        seen[below] = True
    allowed = seen & tables.usual[category][scene.category] & (scene.category >= 0)
    room = TriedRoom.of(scene, tables, seen)
    plain = plain_proposals(room, places.of_category(category), half, allowed, AGAINST, rng)
    own = np.array([*scene.center[obj, :2], _bottom(scene, obj), scene.yaw[obj]])
    both = Proposals(np.append(scene.support[obj], plain.support), np.concatenate([own[None], plain.places]))
    return place_features(room, kinds, category, half, both)


def _bottom(scene: ObservedScene, obj: int) -> float:
    """Its bottom: of what stands on a surface exactly there, as proposals are, or hair's breadths would tell it from
    them."""
    support, surface = int(scene.support[obj]), int(scene.surface[obj])
    if support < 0 or surface < 0:
        return float(scene.center[obj, 2] - scene.half[obj, 2])
    return float(scene.center[support, 2] - scene.half[support, 2] + scene.surfaces(support)[surface, 0])
