"""In which order objects are placed: what holds others first, large before small, and rows from one end to the other.

What holds others is placed first, level by level. Within a level the supports of
all objects are chosen, and then support by support is filled: the floor with reference
objects and then large objects first, others along their length, objects of one category together, as one
lays a row of instruments.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from ...geometry.arrays import Floats, Ints
from ...geometry.planar import rotate
from ...scene.categories import STRUCTURE
from .observed_scene import ObservedScene
from .support_priors import CategoryPriors

DEEPEST = 8
"""Supports under one another told apart; where objects of two kinds may stand on each other there is no end."""

ORDERS = 24
"""Positions of a category on a kind of support that are remembered."""


def levels(priors: CategoryPriors) -> dict[str, int]:
    """How many supports may be under each category, at most :data:`DEEPEST`: all that may hold it come before it."""
    below = {
        name: [prior.support for prior in found if prior.support in priors.supports and prior.support != name]
        for name, found in priors.supports.items()
        if found
    }
    level = dict.fromkeys(below, 0)
    for _ in range(DEEPEST):
        level = {name: max((level.get(other, 0) + 1 for other in below[name]), default=0) for name in below}
    return level


def in_order(counts: Mapping[str, int], priors: CategoryPriors) -> list[str]:
    """One entry per object asked for, in the order of placing."""
    level = levels(priors)
    first = {name: position for position, name in enumerate(priors.references)}

    def key(name: str) -> tuple[int, int, float, str]:
        """What categories are sorted by: level, reference objects, footprint, name."""
        width, depth, _ = priors.sizes.get(name, (0.0, 0.0, 0.0))
        return level.get(name, 0), first.get(name, len(first)), -width * depth, name

    return [name for name in sorted(counts, key=key) for _ in range(int(counts[name]))]


def holders(priors: CategoryPriors) -> set[str]:
    """The categories that are there first: those on which others usually stand, and the building."""
    return {found[0].support for found in priors.supports.values() if found} | {*STRUCTURE}


def groups(vocabulary: Sequence[str], priors: CategoryPriors) -> Ints:
    """By category number: the level at which objects are placed (C + 1,); -1 for unknown ones, which are there."""
    level = levels(priors)
    return np.array([level.get(name, 0) for name in vocabulary] + [-1], np.int64)


def ranks(vocabulary: Sequence[str], priors: CategoryPriors) -> Ints:
    """By category number: the order in which supports are chosen, and in which a floor is filled (C + 1,)."""
    order = in_order({name: 1 for name in vocabulary}, priors)
    return np.array([1 + order.index(name) for name in vocabulary] + [0], np.int64)


def along(scene: ObservedScene) -> Floats:
    """How far along its support each object stands, surface after surface, in 0..1 (K,); 0 without a support."""
    found = np.zeros(len(scene.category))
    for obj in np.flatnonzero(scene.support >= 0):
        support = int(scene.support[obj])
        offset, yaw, half = scene.center[obj] - scene.center[support], scene.yaw[support], scene.half[support]
        side = int(half[1] > half[0])
        share = (rotate(offset, -yaw)[side] / max(half[side], 1e-6) + 1) / 2
        surfaces = max(len(scene.surfaces(support)), 1)
        found[obj] = (max(scene.surface[obj], 0) + np.clip(share, 0, 1)) / surfaces
    return found


def middles(scene: ObservedScene, share: Floats) -> dict[tuple[int, int], float]:
    """The mean of :func:`along` of the objects of one category on one support, by (support, category)."""
    found: dict[tuple[int, int], list[float]] = defaultdict(list)
    for obj in np.flatnonzero(scene.support >= 0):
        found[int(scene.support[obj]), int(scene.category[obj])].append(float(share[obj]))
    return {key: float(np.mean(values)) for key, values in found.items()}


def learn_orders(scenes: Iterable[ObservedScene], vocabulary: Sequence[str]) -> dict[str, list[float]]:
    """Where along a kind of support each category is found, by "Tray>Clamp": some of the training scenes' values."""
    names, found = (*vocabulary, ""), defaultdict(list)
    for scene in scenes:
        for (support, category), share in middles(scene, along(scene)).items():
            if category >= 0 and scene.support[support] >= 0:
                found[f"{names[scene.category[support]]}>{names[category]}"].append(round(share, 3))
    return {key: values[:: max(1, len(values) // ORDERS)][:ORDERS] for key, values in sorted(found.items())}
