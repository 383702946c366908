"""Fronts where the models expect them: what a scene's maker turned otherwise is seen, and placed, by its own front.

The models learn from things that look towards their own -y. A chair of somebody else may look anywhere; which side is
its front is told by its shape (:mod:`...spatial.fronts`) and by how its like stand: with the back to a wall.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np

from ...dataset.assets.asset import Asset
from ...geometry.arrays import Bools, Floats
from ...geometry.planar import rotation, turn
from ...scene import Mesh, SceneGraph
from ...spatial.fronts import CLEAR, OUTWARDS, Front, front_of
from ...spatial.object_rows import Objects, find_objects
from ...spatial.objects import SceneObjects

SMALLEST = 0.3
"""Metres of the longest side of what has a front that matters: tools lie as they lie."""

QUARTER = np.pi / 2
BEHIND, FREE = 0.15, 0.5
"""Metres from a side to a wall that is behind it, and before the opposite side where it is free."""

BACK_TO_WALL = 10.0
"""How many times as likely the side away from a wall is the front, for each thing of a shape that stands so."""


def front_first(asset: Asset) -> Asset:
    """The asset turned so that its front, where its shape tells one, looks towards -y."""
    graph = asset.graph
    found = find_objects(graph, empty=False)
    if not len(found) or max((found.high.max(axis=0) - found.low.min(axis=0))[:2]) < SMALLEST:
        return asset
    front = Front(_by_shape(found, range(len(found)), 0.0))
    if not (front.told and front.side):
        return asset
    local = graph.local.copy()
    local[0] = turn(-front.side * QUARTER) @ local[0]
    return replace(asset, graph=graph.replace(local=local))


def facing(objects: SceneObjects, graph: SceneGraph, movable: Bools, outline: Floats | None) -> SceneObjects:
    """The objects with headings by which their fronts look towards their own -y; ``movable`` (K,) are not building."""
    large = 2 * objects.half[:, :2].max(axis=1) >= SMALLEST
    mine = np.flatnonzero(movable & large & (objects.category >= 0))
    found = find_objects(graph, empty=False)
    chances: dict[int, Floats] = {}
    for obj in mine.tolist():
        number = int(found.of_row[objects.row[obj]])
        if number < 0 or found.rows[number] != objects.row[obj] or not len(found.meshes[number]):
            continue
        shape = _by_shape(found, [number], float(objects.yaw[obj]))
        chances[obj] = shape if outline is None else _with_walls(shape, objects, obj, outline)
    turns = np.zeros(len(objects), np.int64)
    for obj, one in chances.items():
        turns[obj] = one.argmax() if one.max() >= CLEAR else 0
    half = np.where((turns % 2 == 1)[:, None], objects.half[:, [1, 0, 2]], objects.half)
    return replace(objects, yaw=objects.yaw + turns * QUARTER, half=half)


_known: WeakKeyDictionary[Mesh, dict[tuple[object, ...], Floats]] = WeakKeyDictionary()


def _by_shape(found: Objects, numbers: Sequence[int], yaw: float) -> Floats:
    """The chances (4,) of fronts of some objects as one, by their shape, worked out once for each shape."""
    rows = np.concatenate([found.meshes[number] for number in numbers])
    meshes = [found.graph.meshes[mesh] for mesh in found.graph.mesh[rows]]
    poses = rotation(-yaw) @ found.world[rows, :3, :3]
    offsets = (found.world[rows, :3, 3] - found.world[rows[0], :3, 3]) @ rotation(-yaw).T
    key = (*map(id, meshes), (np.round(poses, 3) + 0.0).tobytes(), (np.round(offsets, 3) + 0.0).tobytes())
    known = _known.setdefault(meshes[0], {})
    if key not in known:
        triangles = np.concatenate([found.triangles(number) for number in numbers])
        known[key] = front_of(triangles @ rotation(-yaw).T).chances
    return known[key]


def _with_walls(chances: Floats, objects: SceneObjects, obj: int, outline: Floats) -> Floats:
    """The chances (4,) of fronts once it is seen which side stands before a wall, where the shape does not tell."""
    if chances.max() >= CLEAR:
        return chances
    outwards = OUTWARDS @ rotation(float(objects.yaw[obj]))[:2, :2].T
    reach = objects.half[obj, [1, 0, 1, 0]]
    free = _ways_to_walls(objects.center[obj, :2], outwards, outline) - reach
    backed = (free <= BEHIND) & (free[[2, 3, 0, 1]] >= FREE)
    changed = chances * np.where(backed[[2, 3, 0, 1]], BACK_TO_WALL, 1) / np.where(backed, BACK_TO_WALL, 1)
    return np.asarray(changed / changed.sum())


def _ways_to_walls(point: Floats, ways: Floats, outline: Floats) -> Floats:
    """Metres (N,) from a point (2,) along unit vectors (N, 2) to the outline (C, 2) of the room; infinite where one
    never meets it."""
    edge = np.roll(outline, -1, axis=0) - outline
    step, x, y = outline - point, ways[:, :1], ways[:, 1:]
    across = x * edge[:, 1] - y * edge[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (step[:, 0] * edge[:, 1] - step[:, 1] * edge[:, 0]) / across
        share = (step[:, 0] * y - step[:, 1] * x) / across
    hit = (np.abs(across) > 1e-12) & (along > 0) & (share >= 0) & (share <= 1)
    return np.asarray(np.where(hit, along, np.inf).min(axis=1))
