"""What a generator sees of a scene: objects, their upright boxes, and what each of them stands on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import UniSGError, did_you_mean
from ..geometry.arrays import Floats, Ints
from ..geometry.boxes import Boxes, world_bounds
from ..scene import SceneGraph, subtree
from ..scene.assembly import index_categories
from ..scene.categories import category_numbers
from .entity_boxes import oriented_boxes
from .object_rows import object_rows
from .supports import find_supports


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
        int64 (K,): the first object that holds it, see :func:`~.supports.find_supports`, -1 for none.
    center, half
        (K, 3): middle and half extents of the upright box turned by ``yaw``, metres.
    yaw
        (K,): turn about the vertical, radians.
    parts, owner
        World boxes of the connected parts of the meshes, and int64 (P,) whose they are, ascending.
    relation
        K strings: the relation in which each stands to its support ("on_top_of" ...), "" for none.
    """

    row: Ints
    category: Ints
    support: Ints
    center: Floats
    half: Floats
    yaw: Floats
    parts: Boxes
    owner: Ints
    relation: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.row)

    @property
    def bottom(self) -> Floats:
        """Heights of the lowest points, (K,)."""
        return self.center[:, 2] - self.half[:, 2]

    @property
    def top(self) -> Floats:
        """Heights of the highest points, (K,)."""
        return self.center[:, 2] + self.half[:, 2]

    def parts_of(self, obj: int) -> Boxes:
        """The parts of one object."""
        return self.parts.take(np.arange(*np.searchsorted(self.owner, (obj, obj + 1))))


def scene_objects(graph: SceneGraph, vocabulary: Sequence[str]) -> SceneObjects:
    """The objects of a scene, categories numbered as in ``vocabulary``."""
    supports = find_supports(graph)
    objects = supports.objects
    return SceneObjects(
        objects.rows, category_numbers(graph, vocabulary)[objects.rows], supports.first, *objects.upright, objects.yaw,
        objects.parts.boxes, objects.parts.owner, tuple(supports.first_kind.tolist()),
    )  # fmt: skip


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
        hint = did_you_mean(text, graph.name)
        raise UniSGError(f"nothing in the scene is called {text!r}{hint}: give the name of an object")
    if len(rows) > 1:
        raise UniSGError(f"{len(rows)} objects are called {text!r}: give the uid of one ('unisg inspect' shows it)")
    obj = int(object_rows(graph)[rows[0]])
    if obj < 0:
        raise UniSGError(f"{text!r} has neither a mesh nor a category: take another object or assign a category")
    if obj != rows[0]:
        raise UniSGError(f"{text!r} is a part of {graph.name[obj]!r}: take that")
    if graph.uid[obj] not in uids:
        raise UniSGError(f"{text!r} is a part of the building that holds nothing: take a floor, a wall or an object")
    return list(uids).index(graph.uid[obj])


def as_whole(graph: SceneGraph, text: str) -> SceneGraph:
    """The scenegraph with the group of that uid or name as one object; its parts are what has no category below it.

    A group is an entity that has neither mesh nor category, such as an Xform of a USD file; its name
    becomes its category. Anything else stays as it is.
    """
    rows = [row for row, uid in enumerate(graph.uid) if text in (uid, graph.name[row])]
    if len(rows) != 1 or object_rows(graph)[rows[0]] >= 0 or not (graph.mesh[subtree(graph, rows[0])] >= 0).any():
        return graph
    names = [graph.category_name(row) for row in range(len(graph))]
    names[rows[0]] = graph.name[rows[0]]
    category, vocabulary = index_categories(names)
    return graph.replace(category=category, vocabulary=vocabulary)


def middle_of(graph: SceneGraph, text: str) -> Floats | None:
    """Middle (3,) of the box around the entity with a uid or name and what hangs under it; None if there is none."""
    rows = [row for row, (uid, name) in enumerate(zip(graph.uid, graph.name, strict=True)) if text in (uid, name)]
    if not rows:
        return None
    below = subtree(graph, rows[0])
    boxes = oriented_boxes(graph).take(below[graph.mesh[below] >= 0])
    if not len(boxes.center):
        return np.asarray(graph.world[rows[0], :3, 3])
    low, high = world_bounds(boxes)
    return np.asarray((low.min(axis=0) + high.max(axis=0)) / 2)
