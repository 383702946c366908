"""What the anchor model sees of a scene when it looks for a place for one target."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from .proposals import Scene

TOKENS = 40
"""Things that the model looks at, at most: the support with what holds it, what it holds, then the largest others."""

THIN, LONG, TALL = 0.15, 0.5, 0.6
"""Half extents in metres: what is thinner, longer and taller counts as a wall."""

FLAT = 0.3
"""A root lower than twice this, in metres, is a floor."""

Arrays = dict[str, NDArray[np.float32] | NDArray[np.int64]]


def levels_of(support: NDArray[np.int64]) -> NDArray[np.int64]:
    """Number of supports under each thing, (K,)."""
    level = np.zeros(len(support), np.int64)
    above = support.copy()
    for _ in range(16):
        held = above >= 0
        if not held.any():
            break
        level[held] += 1
        above[held] = support[above[held]]
    return level


def chain(support: NDArray[np.int64], thing: int) -> list[int]:
    """What holds a thing, and what holds that, and so on."""
    found: list[int] = []
    while thing >= 0 and (thing := int(support[thing])) >= 0 and thing not in found:
        found.append(thing)
    return found


def tokens_for(scene: Scene, visible: NDArray[np.int64], parent: int, limit: int = TOKENS) -> NDArray[np.int64]:
    """The things that matter for a target on ``parent``: at most ``limit`` of the ``visible``, the parent first."""
    x, y, z = scene.half.T
    size = x * y + x * z + y * z
    rank = 1.0 / (1.0 + size)
    if parent >= 0:
        rank = np.where(scene.support == parent, rank - 1, rank)
        held_by = chain(scene.support, parent)
        rank[held_by] -= 2
        rank[parent] = -4
    order = visible[np.argsort(rank[visible], kind="stable")]
    return order[:limit]


def context_arrays(scene: Scene, tokens: NDArray[np.int64], category: int, parent: int, unknown: int) -> Arrays:
    """Inputs of the model for one target and its tokens (M,).

    Walls have their thin side along y and know on which side the room is.
    """
    half, yaw = scene.half[tokens], scene.yaw[tokens]
    wall = (half[:, :2].min(axis=1, initial=np.inf) < THIN) & (half[:, :2].max(axis=1, initial=0) > LONG)
    wall &= half[:, 2] > TALL
    swap = wall & (half[:, 0] < half[:, 1])
    half = np.where(swap[:, None], half[:, [1, 0, 2]], half)
    yaw = yaw + swap * (np.pi / 2)
    center = scene.center[tokens]
    middle = room_middle(scene)
    side = -np.sin(yaw) * (middle[0] - center[:, 0]) + np.cos(yaw) * (middle[1] - center[:, 1])
    box = np.column_stack([center - (0, 0, ground_of(scene)), half, np.cos(yaw), np.sin(yaw)])
    level = levels_of(scene.support)[tokens]
    flags = np.column_stack([
        tokens == parent,
        (scene.support[tokens] == parent) & (parent >= 0),
        np.isin(tokens, chain(scene.support, parent)),
        scene.category[tokens] == category,
        np.where(wall, np.where(side >= 0, 1.0, -1.0), 0.0),
        level / 4,
    ])  # fmt: skip
    known = np.where(scene.category[tokens] < 0, unknown, scene.category[tokens])
    return {"category": known.astype(np.int64), "box": box.astype(np.float32), "flags": flags.astype(np.float32)}


def room_root(scene: Scene) -> int:
    """The thing without a support that has the largest footprint, -1 for none."""
    roots = np.flatnonzero(scene.support < 0)
    return int(roots[np.argmax(scene.half[roots, 0] * scene.half[roots, 1])]) if len(roots) else -1


def room_middle(scene: Scene) -> NDArray[np.float64]:
    """Where the room's middle is, (2,) metres."""
    root = room_root(scene)
    return scene.center[root, :2] if root >= 0 else np.zeros(2)


def ground_of(scene: Scene) -> float:
    """Height on which the room's furniture stands: the upper side of a flat root, metres."""
    root = room_root(scene)
    return float(scene.center[root, 2] + scene.half[root, 2]) if root >= 0 and scene.half[root, 2] < FLAT else 0.0


def support_arrays(scene: Scene, things: NDArray[np.int64], category: int, unknown: int) -> Arrays:
    """Inputs for choosing the support among ``things`` (K,): what they are, their size, and what they hold already."""
    seen = np.zeros(len(scene.support) + 1, bool)
    seen[things] = True
    held = seen[:-1] & (scene.support >= 0)
    area = 4 * scene.half[:, 0] * scene.half[:, 1]
    count = len(scene.support)
    below = scene.support[held]
    same = np.bincount(below[scene.category[held] == category], minlength=count)
    everything = np.bincount(below, minlength=count)
    covered = np.bincount(below, weights=area[held], minlength=count) / np.maximum(area, 1e-4)
    level = levels_of(scene.support)
    known = np.where(scene.category[things] < 0, unknown, scene.category[things])
    load = np.column_stack([
        np.log1p(same[things]), np.log1p(everything[things]), np.minimum(covered[things], 2.0), level[things] / 4
    ])  # fmt: skip
    return {
        "support_category": known.astype(np.int64),
        "support_half": scene.half[things].astype(np.float32),
        "support_load": load.astype(np.float32),
    }


PLAN_WIDTH = 5


def plan_vector(
    scene: Scene, visible: NDArray[np.int64], category: int, parent: int, coming: Mapping[int, int]
) -> NDArray[np.float32]:
    """What is there and what is still to come besides the target, (PLAN_WIDTH,): logarithms of counts."""
    there = scene.category[visible]
    return np.log1p([
        (there == category).sum(),
        coming.get(category, 0),
        (scene.support[visible] == parent).sum() if parent >= 0 else 0,
        len(visible),
        sum(coming.values()),
    ]).astype(np.float32)  # fmt: skip


def coming_vector(coming: Mapping[int, int], categories: int) -> NDArray[np.float32]:
    """Logarithms of the counts still to come, by category (C,)."""
    counts = np.zeros(categories, np.float32)
    for number, count in coming.items():
        counts[number] = count
    return np.log1p(counts)
