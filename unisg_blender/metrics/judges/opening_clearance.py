"""Is the place before doors and windows free? Opening clearance as SceneEval defines it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Floats
from ...geometry.box_overlap import penetration
from ...geometry.boxes import Boxes
from ...geometry.polygon import inside
from ...scene.graph import SceneGraph
from ...spatial.object_rows import Objects, find_objects
from ...spatial.structure.room_objects import room_objects
from ..scene_validity import counted_objects

KINDS = ("Door", "Window")
WINDOW_DEPTH = 0.5
"""Metres before a window that are to be free; before a door it is the door's width."""

INTO_ROOM = 0.1
"""Metres before an opening at which the floor of the room is looked for."""

TOUCH = 1e-3
"""Metres that a thing may reach into the place before an opening."""


@dataclass(frozen=True)
class OpeningSide:
    """A side of a door or a window: row, category, and the rows of the things that stand or hang before it."""

    row: int
    kind: str
    before: tuple[int, ...]


def openings(graph: SceneGraph) -> list[OpeningSide]:
    """The sides of doors and windows that look into the room, with what is in the way there.

    Each has a box before it, as wide and high as it is and as deep as a door is wide, or :data:`WINDOW_DEPTH` before a
    window. SceneEval's code looks for the triangles of things in that box; here the boxes of their parts are taken.
    A curtain is before its window.
    """
    outline = room_objects(graph, ()).outline
    objects = find_objects(graph, empty=False)
    names = [graph.category_name(row) for row in objects.rows]
    counted = counted_objects(graph)[objects.rows]
    thing = counted[objects.parts.owner]
    parts, owner = objects.parts.boxes.take(np.flatnonzero(thing)), objects.parts.owner[thing]
    found = []
    for obj in (number for number, name in enumerate(names) if name in KINDS):
        for place in _places(objects, obj, names[obj], outline):
            deep = penetration(place.take(np.zeros(len(owner), np.int64)), parts) > TOUCH
            rows = objects.rows[np.unique(owner[deep])]
            found.append(OpeningSide(int(objects.rows[obj]), names[obj], tuple(rows.tolist())))
    return found


def _places(objects: Objects, obj: int, kind: str, outline: Floats | None) -> list[Boxes]:
    """The boxes before an opening, on the sides from which one sees the floor; all sides without a floor."""
    box = objects.oriented.take(np.array([obj]))
    axes, half, center = box.axes[0], box.half[0], box.center[0]
    up = int(np.abs(axes[2]).argmax())
    thin, wide = sorted((axis for axis in range(3) if axis != up), key=lambda axis: half[axis])
    depth = 2 * half[wide] if kind == "Door" else WINDOW_DEPTH
    found = []
    for side in (1.0, -1.0):
        out = side * axes[:, thin]
        if outline is None or inside(outline, (center + out * (half[thin] + INTO_ROOM))[None, :2])[0]:
            size = half.copy()
            size[thin] = depth / 2
            found.append(Boxes((center + out * depth / 2)[None], box.axes, size[None], box.solid))
    return found
