"""What a generator sees of a scene: objects, their upright boxes, and what each of them stands on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..geometry.boxes import _CORNERS, Boxes, covers, part_tops
from ..geometry.planar import heading, turned
from ..scene import SceneGraph, world_matrices
from .part_boxes import part_boxes

CONTACT = 0.02
"""Metres within which a bottom counts as resting on a surface."""


@dataclass(frozen=True, eq=False)
class SceneObjects:
    """The objects of a scene, K of them with P parts: entities with their uncategorised descendants.

    Attributes
    ----------
    row
        int64 (K,): row of the entity in the scene.
    category
        int64 (K,): position in the vocabulary asked for, -1 for others.
    support
        int64 (K,): the object that it is parented to or else rests on, -1 for none.
    center, half
        (K, 3): middle and half extents of the upright box turned by ``yaw``, metres.
    yaw
        (K,): turn about the vertical, radians.
    parts, owner
        World boxes of the connected parts of the meshes, and int64 (P,) whose they are, ascending.
    relation
        K strings: the relation in which each stands to its support ("on_top_of" ...), "" for none.
    """

    row: NDArray[np.int64]
    category: NDArray[np.int64]
    support: NDArray[np.int64]
    center: NDArray[np.float64]
    half: NDArray[np.float64]
    yaw: NDArray[np.float64]
    parts: Boxes
    owner: NDArray[np.int64]
    relation: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.row)

    @property
    def bottom(self) -> NDArray[np.float64]:
        """Heights of the lowest points, (K,)."""
        return self.center[:, 2] - self.half[:, 2]

    @property
    def top(self) -> NDArray[np.float64]:
        """Heights of the highest points, (K,)."""
        return self.center[:, 2] + self.half[:, 2]

    def parts_of(self, obj: int) -> Boxes:
        """The parts of one object."""
        return self.parts.take(np.arange(*np.searchsorted(self.owner, (obj, obj + 1))))


def scene_objects(graph: SceneGraph, vocabulary: Sequence[str]) -> SceneObjects:
    """The objects of a scene, categories numbered as in ``vocabulary``."""
    object_at = object_rows(graph)
    rows, place = np.unique(object_at[object_at >= 0], return_inverse=True)
    number = np.full(len(graph) + 1, -1, np.int64)
    number[np.flatnonzero(object_at >= 0)] = place
    shapes = part_boxes(graph)
    owner = number[shapes.owner]
    order = np.argsort(owner, kind="stable")
    parts, owner = shapes.boxes.take(order), owner[order]
    world = world_matrices(graph)[rows]
    yaw = heading(world[:, :3, :3])
    center, half = _upright(parts, owner, yaw, world[:, :3, 3])
    known = {name: position for position, name in enumerate(vocabulary)}
    codes = np.array([known.get(name, -1) for name in graph.vocabulary] + [-1], np.int64)
    above = graph.parent[rows]
    parent = np.where(above >= 0, number[above], -1)
    category = codes[graph.category[rows]]
    support = _with_supports(SceneObjects(rows, category, parent, center, half, yaw, parts, owner, ()))
    relation = _relations(graph, rows, number, support)
    return SceneObjects(rows, category, support, center, half, yaw, parts, owner, relation)


def _relations(
    graph: SceneGraph, rows: NDArray[np.int64], number: NDArray[np.int64], support: NDArray[np.int64]
) -> tuple[str, ...]:
    found = [""] * len(rows)
    table = graph.components.get("relations")
    if table is not None:
        for row, kind, uid in zip(table.rows, table.columns["kind"], table.columns["target"], strict=True):
            obj, target = number[row], number[graph.row_of_uid.get(uid, -1)]
            if obj >= 0 and rows[obj] == row and target >= 0 and target == support[obj]:
                found[obj] = str(kind)
    return tuple(found)


def find_object(graph: SceneGraph, uids: Sequence[str], text: str) -> int:
    """The number of the object with a uid or name, among objects with these uids.

    Raises
    ------
    UniSGError
        If it is not there, there are several, or it is no object.
    """
    if text in uids:
        return list(uids).index(text)
    rows = [row for row, name in enumerate(graph.name) if name == text]
    if not rows:
        raise UniSGError(f"nothing in the scene is called {text!r}: give the name of an object")
    if len(rows) > 1:
        raise UniSGError(f"{len(rows)} objects are called {text!r}: give the uid of one ('unisg inspect' shows it)")
    obj = int(object_rows(graph)[rows[0]])
    if obj < 0:
        raise UniSGError(f"{text!r} has neither a mesh nor a category: take another object or assign a category")
    if obj != rows[0]:
        raise UniSGError(f"{text!r} is a part of {graph.name[obj]!r}: take that")
    return list(uids).index(graph.uid[obj])


def object_rows(graph: SceneGraph) -> NDArray[np.int64]:
    """int64 (N,): for each entity the row of the object that it is or belongs to, -1 for none.

    An object is an entity with a category, or one with a mesh that hangs under none.
    """
    category, mesh = graph.category.tolist(), graph.mesh.tolist()
    found: list[int] = []
    for row, parent in enumerate(graph.parent.tolist()):  # parents come first
        above = found[parent] if parent >= 0 else -1
        if category[row] < 0 and above >= 0 and category[above] >= 0:
            found.append(above)
        else:
            found.append(row if category[row] >= 0 or mesh[row] >= 0 else -1)
    return np.array(found, np.int64)


def _upright(
    parts: Boxes, owner: NDArray[np.int64], yaw: NDArray[np.float64], origin: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centres and half extents of the objects' boxes; objects without geometry have a point at their origin."""
    corners = parts.center[:, None] + (_CORNERS * parts.half[:, None]) @ np.swapaxes(parts.axes, 1, 2)
    seen = turned(corners, -yaw[owner][:, None])
    low, high = np.full((len(yaw), 3), np.inf), np.full((len(yaw), 3), -np.inf)
    if len(owner):
        first = np.flatnonzero(np.diff(owner, prepend=-1))
        low[owner[first]] = np.minimum.reduceat(seen.min(axis=1), first)
        high[owner[first]] = np.maximum.reduceat(seen.max(axis=1), first)
    bare = ~np.isfinite(low[:, 0])
    low[bare] = high[bare] = turned(origin, -yaw)[bare]
    return turned((low + high) / 2, yaw), (high - low) / 2


def _with_supports(objects: SceneObjects) -> NDArray[np.int64]:
    """The supports, where roots and what hangs under something without geometry get the object that they rest on."""
    support = objects.support.copy()
    bare = objects.half.max(axis=1) <= 0
    for obj in np.flatnonzero((support < 0) | bare[np.maximum(support, 0)]):
        below = resting_on(objects, int(obj))
        if below >= 0:
            support[obj] = below
    return support


def resting_on(objects: SceneObjects, obj: int) -> int:
    """The object on one of whose parts the bottom of ``obj`` rests, the highest one; -1 for none."""
    own = objects.owner == obj
    tops = part_tops(objects.parts)
    near = (np.abs(tops - objects.bottom[obj]) <= CONTACT) & ~own
    if not near.any() or not own.any():
        return -1
    under = np.flatnonzero(near & covers(objects.parts, objects.center[obj, :2]))
    return int(objects.owner[under[np.argmax(tops[under])]]) if len(under) else -1
