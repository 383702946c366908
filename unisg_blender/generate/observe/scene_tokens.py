"""What the anchor model sees of a scene when it looks for a place for one target."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays import Bools, Floats, Ints
from .observed_scene import ObservedScene

TOKENS = 32
"""Objects that the model looks at, at most: the support with what holds it and what it holds, then what is near."""

NEAR, MOST_NEAR, OTHER_LEVEL = 1.0, 8, 0.15
"""What is near but on something else: within so many metres of the support, and so many objects at most.

What is above or below the target counts as so much farther away: a lamp has to see the table.
"""

WIDE = 1.0
"""Something whose half extent is more than this, such as a ceiling rail, sees the largest objects wherever they are."""

THIN, LONG, TALL = 0.15, 0.5, 0.6
"""Half extents in metres: what is thinner, longer and taller counts as a wall."""

FLAT = 0.3
"""A root lower than twice this, in metres, is a floor."""

Arrays = dict[str, NDArray[np.float32] | Ints]

FLAGS, PLAN_WIDTH = 7, 8
TINY = 1e-4


def levels_of(support: Ints) -> Ints:
    """Number of supports under each object, (K,)."""
    level = np.zeros(len(support), np.int64)
    above = support.copy()
    for _ in range(16):
        held = above >= 0
        if not held.any():
            break
        level[held] += 1
        above[held] = support[above[held]]
    return level


def chain(support: Ints, obj: int) -> list[int]:
    """What holds an object, and what holds that, and so on."""
    found: list[int] = []
    while obj >= 0 and (obj := int(support[obj])) >= 0 and obj not in found:
        found.append(obj)
    return found


def tokens_for(scene: ObservedScene, seen: Bools, parent: int, surface: int, bottom: float, target: Floats) -> Ints:
    """The objects that matter for a target on a surface of ``parent``: at most :data:`TOKENS`, the parent first.

    ``seen`` bool (K,) says what is there; ``target`` (3,) are half extents, its bottom is at ``bottom``, metres.
    """
    support, half, center = scene.support, scene.half, scene.center
    if parent < 0:
        rank = -half.max(axis=1)
    else:
        held_by = chain(support, parent)
        away = _apart(scene, parent)
        beside = (center[:, 2] - half[:, 2] < bottom + 2 * target[2]) & (center[:, 2] + half[:, 2] > bottom + 0.001)
        rank = away - half[:, :2].min(axis=1).clip(max=1) / 5  # of those that are equally near the larger ones
        rank = np.where(away < NEAR, np.where(beside, rank, rank + OTHER_LEVEL), np.inf)
        if target[:2].max() > WIDE:
            rank = -half[:, :2].prod(axis=1)
        if held_by:
            rank[held_by] = rank[parent] = np.inf
            rank[np.where(seen, rank, np.inf).argsort(kind="stable")[MOST_NEAR:]] = np.inf
        siblings = support == parent
        rank = np.where(siblings & (beside | (scene.surface == surface)), -2 - half.max(axis=1), rank)
        rank = np.where(siblings & (scene.surface == surface), rank - 20, rank)
        rank[held_by] = -1000
        rank[parent] = -2000
    rank = np.where(seen, rank, np.inf)
    order = np.argsort(rank, kind="stable")[:TOKENS]
    return order[np.isfinite(rank[order])]


def _apart(scene: ObservedScene, parent: int) -> Floats:
    """How far each object's middle is from the parent's footprint, or the parent's from the object's, metres (K,)."""
    x, y = (scene.center[:, :2] - scene.center[parent, :2]).T
    found = []
    for yaw, half in ((scene.yaw[parent], scene.half[parent]), (scene.yaw, scene.half.T)):
        cos, sin = np.cos(yaw), np.sin(yaw)
        along, across = np.abs(cos * x + sin * y) - half[0], np.abs(cos * y - sin * x) - half[1]
        found.append(np.hypot(np.maximum(along, 0), np.maximum(across, 0)))
    return np.minimum(*found)


def context_arrays(
    scene: ObservedScene, tokens: Ints, category: int, parent: int, surface: int, unknown: int
) -> Arrays:
    """Inputs of the model for one target and its tokens (M,).

    Walls have their thin side along y and know on which side the room is.
    """
    room = room_of(scene)
    half, yaw = scene.half[tokens], scene.yaw[tokens]
    swap = room.swap[tokens]
    half[swap] = half[swap][:, [1, 0, 2]]
    yaw[swap] += np.pi / 2
    count = len(tokens)
    box, flags = np.empty((count, 8), np.float32), np.zeros((count, FLAGS), np.float32)
    box[:, :3], box[:, 3:6], box[:, 6], box[:, 7] = scene.center[tokens], half, np.cos(yaw), np.sin(yaw)
    box[:, 2] -= room.ground
    held_by = np.zeros(len(scene.category), bool)
    held_by[chain(scene.support, parent)] = True
    kind = scene.category[tokens]
    flags[:, 0] = tokens == parent
    flags[:, 1] = sibling = (scene.support[tokens] == parent) & (parent >= 0)
    flags[:, 2] = held_by[tokens]
    flags[:, 3] = kind == category
    flags[:, 4] = room.inner[tokens]
    flags[:, 5] = room.level[tokens] / 4
    flags[:, 6] = sibling & (scene.surface[tokens] == surface)
    return {"category": np.where(kind < 0, unknown, kind), "box": box, "flags": flags}


@dataclass(frozen=True, eq=False)
class Room:
    """What is the same for all targets: ``ground`` in metres, and of each object (K,) its ``level``.

    ``swap`` says which objects are walls whose thin side is along x, ``inner`` on which side
    of a wall the room is: 1 towards y, -1 away, 0 for what is no wall.
    """

    ground: float
    level: Ints
    swap: Bools
    inner: Floats


def room_of(scene: ObservedScene) -> Room:
    """Found once for a scene, and again when something was added."""
    if not isinstance(scene.room, Room):
        half, middle = scene.half, room_middle(scene)
        wall = (half[:, :2].min(axis=1, initial=np.inf) < THIN) & (half[:, :2].max(axis=1, initial=0) > LONG)
        wall &= half[:, 2] > TALL
        swap = wall & (half[:, 0] < half[:, 1])
        yaw, offset = scene.yaw + swap * (np.pi / 2), middle - scene.center[:, :2]
        side = np.cos(yaw) * offset[:, 1] - np.sin(yaw) * offset[:, 0]
        inner = np.where(wall, np.where(side >= 0, 1.0, -1.0), 0.0)
        scene.room = Room(ground_of(scene), levels_of(scene.support), swap, inner)
    return scene.room


def room_root(scene: ObservedScene) -> int:
    """The object without a support that has the largest footprint, -1 for none."""
    roots = np.flatnonzero(scene.support < 0)
    return int(roots[np.argmax(scene.half[roots, 0] * scene.half[roots, 1])]) if len(roots) else -1


def room_middle(scene: ObservedScene) -> Floats:
    """Where the room's middle is, (2,) metres."""
    root = room_root(scene)
    return scene.center[root, :2] if root >= 0 else np.zeros(2)


def ground_of(scene: ObservedScene) -> float:
    """Height on which the room's furniture stands: the upper side of a flat root, metres."""
    root = room_root(scene)
    return float(scene.center[root, 2] + scene.half[root, 2]) if root >= 0 and scene.half[root, 2] < FLAT else 0.0


def plan_vector(
    scene: ObservedScene, seen: Bools, category: int, parent: int, surface: int, half: Floats,
    coming: Mapping[int, int], coming_area: float, whole: bool,
) -> NDArray[np.float32]:  # fmt: skip
    """What is there and what is still to come to this surface besides the target, (PLAN_WIDTH,).

    Logarithms of counts, shares of the surface's area that are covered, the target's own, and still to be covered, and
    whether that is the ``whole`` of what the surface will hold, put there in order.
    """
    there = seen & (scene.support == parent) & (scene.surface == surface) & (parent >= 0)
    same = seen & (scene.category == category)
    area = TINY
    if parent >= 0:
        surfaces = scene.surfaces(parent)
        area = float(surfaces[surface, 1]) if surface >= 0 else float(4 * scene.half[parent, :2].prod())
    footprint = 4 * scene.half[there, :2].prod(axis=1).sum()
    counts = [same.sum(), (same & there).sum(), there.sum(), coming.get(category, 0), sum(coming.values())]
    shares = np.minimum(np.array([footprint + 4 * half[:2].prod(), coming_area]) / max(area, TINY), 2.0)
    return np.concatenate([np.log1p(counts), shares, [whole]]).astype(np.float32)


def coming_vector(coming: Mapping[int, int], categories: int) -> NDArray[np.float32]:
    """Logarithms of the counts still to come, by category (C,)."""
    counts = np.zeros(categories, np.float32)
    for number, count in coming.items():
        counts[number] = count
    return np.log1p(counts)
