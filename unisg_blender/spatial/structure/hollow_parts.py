"""Things whose boxes are full of air, such as all skirtings of a house in one mesh: their faces count instead."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.boxes import Boxes, world_bounds
from ...scene.graph import SceneGraph
from ..object_rows import object_rows
from ..objects import SceneObjects
from .scan import world_triangles
from .triangle_boxes import triangle_boxes

BROAD, HIGH, FILLED = 3.0, 0.3, 0.6
"""Square metres of the rectangle around a part from which on, and metres of its height from which on, it is looked at;
and the share of that rectangle that level faces of the thing cover, at least, if it is no hollow one."""

LEVEL = 0.7
"""Upward part of the unit normal of a level face at least."""

MOST = 20_000
"""Triangles of a thing up to which its faces are taken."""


def with_faces(graph: SceneGraph, objects: SceneObjects, looked_at: Bools) -> tuple[Boxes, Ints]:
    """Part boxes of K objects and whose they are; those of hollow ones, of ``looked_at`` (K,), lie on their faces."""
    low, high = world_bounds(objects.parts)
    size = high - low
    broad = (size[:, :2].prod(axis=1) > BROAD) & (size[:, 2] > HIGH) & looked_at[objects.owner]
    if not broad.any():
        return objects.parts, objects.owner
    triangles, row = world_triangles(graph)
    owner_row = object_rows(graph)[row]
    gone, boxes, owner = np.zeros(len(objects), bool), [], []
    for obj in np.unique(objects.owner[broad]).tolist():
        mine = triangles[owner_row == objects.row[obj]]
        if 0 < len(mine) <= MOST and _is_hollow(mine, float(size[objects.owner == obj, :2].prod(axis=1).max())):
            faces = triangle_boxes(mine)
            gone[obj] = True
            boxes.append(faces)
            owner.append(np.full(len(faces.center), obj))
    kept = np.flatnonzero(~gone[objects.owner])
    parts = [objects.parts.take(kept), *boxes]
    fields = ("center", "axes", "half", "solid")
    order = np.argsort(numbers := np.concatenate([objects.owner[kept], *owner]), kind="stable")
    return Boxes(*(np.concatenate([getattr(part, name) for part in parts])[order] for name in fields)), numbers[order]


def _is_hollow(triangles: Floats, area: float) -> bool:
    """Do the faces of a thing that look up cover little of the rectangle around it?"""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    level = np.abs(normal[:, 2]) > LEVEL * np.linalg.norm(normal, axis=1)
    return bool(np.abs(normal[level, 2]).sum() / 4 < FILLED * area)  # seen from above and from below
