"""Which things of a scene move as one, and which do not move: the building, and what is fixed to it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Bools, Ints
from ...geometry.box_overlap import penetration
from ...geometry.boxes import part_tops
from ...scene.categories import STRUCTURE, has_category
from ...scene.graph import SceneGraph
from ..supports import CONTACT, Supports, find_supports

TOUCHES = 0.03
"""Metres between the boxes of a thing and of what holds it within which it is fixed there."""


@dataclass(frozen=True, eq=False)
class RigidBody:
    """Things that move as one.

    Attributes
    ----------
    row
        Row of the object whose frame it has; -1 for all that does not move.
    objects
        Rows of the objects of it: the first is ``row``, the others hang from it.
    meshes
        Rows of their meshes.
    """

    row: int
    objects: Ints
    meshes: Ints


def rigid_bodies(graph: SceneGraph, fixed: Collection[int] = ()) -> list[RigidBody]:
    """The bodies of a scene; the first is what does not move.

    Structure (:data:`~...scene.categories.STRUCTURE`) and the objects at the rows ``fixed`` do not move. What hangs
    from a thing, or is in a wall, is of its body if it touches it, within :data:`TOUCHES`; so is what stands on nothing
    and touches structure.
    """
    supports = find_supports(graph)
    objects = supports.objects
    rows, count = objects.rows, len(objects)
    still = has_category(graph, STRUCTURE)[rows] | np.isin(rows, np.fromiter(fixed, np.int64))
    carrier = _carriers(supports, still)
    of_body = np.where(still, -1, np.arange(count))
    for obj in range(count):
        above, seen = obj, {obj}
        while not still[above] and carrier[above] >= 0 and carrier[above] not in seen:
            above = int(carrier[above])
            seen.add(above)
        of_body[obj] = -1 if still[above] else above
    solid = np.array([len(own) > 0 for own in objects.meshes], bool)
    bodies = []
    for body in (-1, *np.unique(of_body[(of_body >= 0) & solid]).tolist()):
        own = np.flatnonzero(of_body == body)
        own = own[np.argsort(own != body, kind="stable")]
        meshes = np.concatenate([np.zeros(0, np.int64), *(objects.meshes[obj] for obj in own)])
        bodies.append(RigidBody(int(rows[body]) if body >= 0 else -1, rows[own], meshes))
    return bodies


def _carriers(supports: Supports, still: Bools) -> Ints:
    """int64 (K,): the object that each is fixed to, -1 for none."""
    objects = supports.objects
    names = [objects.graph.category_name(row) for row in objects.rows]
    found = np.full(len(objects), -1, np.int64)
    upright = [obj for obj, name in enumerate(names) if name in STRUCTURE and name not in ("Floor", "Stairs")]
    for obj in np.flatnonzero(~still).tolist():
        holder, kind = int(supports.first[obj]), str(supports.first_kind[obj])
        if kind == "hangs_from" or (kind == "inside" and still[holder]):
            asked = [holder]
        else:
            told = kind or (holder >= 0 and (names[holder] not in STRUCTURE or _rests(supports, obj, holder)))
            asked = [] if told else upright
        found[obj] = next((other for other in asked if _touch(supports, obj, other)), -1)
    return found


def _rests(supports: Supports, obj: int, holder: int) -> bool:
    """Is the bottom of an object as high as the top of some part of another?"""
    center, half = supports.objects.upright
    parts = supports.objects.parts
    tops = part_tops(parts.boxes.take(np.flatnonzero(parts.owner == holder)))
    return bool((np.abs(tops - (center[obj, 2] - half[obj, 2])) <= CONTACT).any())


def _touch(supports: Supports, obj: int, other: int) -> bool:
    """Do the part boxes of an object come within :data:`TOUCHES` of those of another?"""
    parts = supports.objects.parts
    mine, theirs = np.flatnonzero(parts.owner == obj), np.flatnonzero(parts.owner == other)
    if not len(mine) or not len(theirs):
        return False
    one, two = (each.reshape(-1) for each in np.meshgrid(mine, theirs, indexing="ij"))
    return bool((penetration(parts.boxes.take(one), parts.boxes.take(two)) >= -TOUCHES).any())
