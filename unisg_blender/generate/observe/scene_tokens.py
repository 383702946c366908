"""What the anchor model sees of a scene when it looks for a place for one target."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.planar import outside_rectangle
from .observed_scene import ObservedScene

TOKENS = 32
"""Objects that the model looks at, at most: the support with what holds it and what it holds, then what is near."""

NEAR, MOST_NEAR, OTHER_LEVEL = 1.0, 8, 0.15
"""What is near but on something else: within so many metres of the support, and so many objects at most.

What is above or below the target counts as so much farther away: a lamp has to see the table.
"""

LARGER = 5.0
"""Of objects that are equally near the larger ones count: as nearer by their smaller half extent divided by this."""

PARENT, HOLDER, SAME_SURFACE, SIBLING = -2000.0, -1000.0, -20.0, -2.0
"""Ranks, in metres, of what is not ranked by distance: the support first, then what holds it, then what else it holds,
that on the target's own surface before the rest; so far apart that no room is as wide and no object as large."""

ABOVE = 0.001
"""Metres by which something has to reach above the target's bottom to be beside it."""

WIDE = 1.0
"""Something whose half extent is more than this, such as a ceiling rail, sees the largest objects wherever they are."""

Arrays = dict[str, NDArray[np.float32] | Ints]

FLAGS, PLAN_WIDTH = 7, 8
TINY = 1e-4


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
        held_by, away = chain(support, parent), _apart(scene, parent)
        beside = (center[:, 2] - half[:, 2] < bottom + 2 * target[2]) & (center[:, 2] + half[:, 2] > bottom + ABOVE)
        rank = away - half[:, :2].min(axis=1).clip(max=1) / LARGER
        rank = np.where(away < NEAR, np.where(beside, rank, rank + OTHER_LEVEL), np.inf)
        if target[:2].max() > WIDE:
            rank = -half[:, :2].prod(axis=1)
        if held_by:
            rank[held_by] = rank[parent] = np.inf
            rank[np.where(seen, rank, np.inf).argsort(kind="stable")[MOST_NEAR:]] = np.inf
        siblings, here = support == parent, (support == parent) & (scene.surface == surface)
        rank = np.where(siblings & (beside | here), SIBLING - half.max(axis=1), rank)
        rank = np.where(here, rank + SAME_SURFACE, rank)
        rank[held_by], rank[parent] = HOLDER, PARENT
    rank = np.where(seen, rank, np.inf)
    order = np.argsort(rank, kind="stable")[:TOKENS]
    return order[np.isfinite(rank[order])]


def _apart(scene: ObservedScene, parent: int) -> Floats:
    """How far each object's middle is from the parent's footprint, or the parent's from the object's, metres (K,)."""
    offset = scene.center[:, :2] - scene.center[parent, :2]
    there = outside_rectangle(offset, scene.yaw[parent], scene.half[parent, :2])
    return np.minimum(there, outside_rectangle(offset, scene.yaw, scene.half[:, :2]))


def context_arrays(
    scene: ObservedScene, tokens: Ints, category: int, parent: int, surface: int, unknown: int
) -> Arrays:
    """Inputs of the model for one target and its tokens (M,).

    Walls have their thin side along y and know on which side the room is.
    """
    room = scene.room
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
