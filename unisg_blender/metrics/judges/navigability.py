"""How much of a room's free floor people can reach: navigability as SceneEval and PhyScene define it."""

from __future__ import annotations

import numpy as np

from ...scene.graph import SceneGraph
from ...spatial.free_floor import HEAD, WIDTH, FreeFloor
from ...spatial.object_rows import find_objects
from ...spatial.structure.room_objects import room_objects
from ..scene_validity import counted_objects


def navigability(graph: SceneGraph, width: float = WIDTH, step: float = 0.0) -> float | None:
    """The share of the free floor of a scene's room that is connected, 0..1; None of a scene without a room.

    Things are their boxes, turned about the vertical; those whose middle is 2 m over the floor are out of the way.

    Parameters
    ----------
    graph
        The scene, metres.
    width
        Metres across of whoever walks.
    step
        Metres over the floor up to which things are walked over. SceneEval counts a rug as in the way: 0.
    """
    room = room_objects(graph, ())
    if room.outline is None:
        return None
    if room.structure is not None:
        heights = [each.floor for each in room.structure.rooms if each.outline is room.outline]
        ground = heights[0]
    else:
        ground = float((room.objects.center + room.objects.half)[room.floor, 2].max())
    objects, floor = find_objects(graph, empty=False), FreeFloor.of(room.outline, width)
    center, half = objects.upright
    for obj in np.flatnonzero(counted_objects(graph)[objects.rows]).tolist():
        high = center[obj, 2] - ground
        if high <= HEAD and high + half[obj, 2] > step:
            floor = floor.without(center[obj, :2], half[obj, :2], float(objects.yaw[obj]))
    return floor.reachable
