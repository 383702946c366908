"""Which things cut the floor of a room whose categories tell it into pieces between which nobody can walk."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...scene import SceneGraph
from ...scene.categories import STRUCTURE, has_category
from ...spatial.free_floor import HEAD, STEP, FreeFloor
from ...spatial.object_rows import find_objects


def cutting_floor(graph: SceneGraph, outline: Floats, ground: float, uids: Sequence[str], gone: Bools) -> list[str]:
    """Which of some things leave a piece of floor that matters apart from the rest; of several the later ones.

    Parameters
    ----------
    graph, gone
        The scene, and which of its rows (N,) are not looked at.
    outline, ground
        The floor (K, 2) and its height, metres.
    uids
        The things; all others are there already.
    """
    objects = find_objects(graph, empty=False)
    center, half = objects.upright
    high = center[:, 2] - ground
    there = (high <= HEAD) & (high + half[:, 2] > STEP) & ~has_category(graph, STRUCTURE)[objects.rows]
    there &= ~gone[objects.rows]
    asked = {int(objects.of_row[graph.row_of_uid[uid]]): uid for uid in uids}
    floor, found = FreeFloor.of(outline), []
    others = [obj for obj in np.flatnonzero(there).tolist() if obj not in asked]
    for obj in [*others, *(obj for obj in asked if obj >= 0 and there[obj])]:
        after = floor.without(center[obj, :2], half[obj, :2], float(objects.yaw[obj]))
        if obj in asked and after.places > max(floor.places, 1):
            found.append(asked[obj])
        else:
            floor = after
    return found
