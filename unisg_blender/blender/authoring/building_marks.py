"""Write onto Blender objects what the user says of the building; see :mod:`unisg_blender.scene.structure_marks`."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np
from numpy.typing import NDArray

from ...scene.properties import CATEGORY, UID
from ...scene.structure_marks import NO_ROOM, PART_MARK, ROOM_MARK, part_category
from .identities import assign_category, ensure_uid

HIGH, SIZE = 1.0, 0.15
"""Metres over the floor of the Empty that says what a room is, and its size."""


def mark_parts(objects: Iterable[bpy.types.Object], part: str) -> int:
    """Say that objects are a part of the building, a thing or nothing; "" takes back what was said.

    Linked objects are passed over. Returns the number of objects that were marked.
    """
    marked = [item for item in objects if item.library is None]
    for item in marked:
        category, mark = part_category(part, str(item.get(CATEGORY, "")))
        assign_category([item], category)
        if mark:
            item[PART_MARK] = mark
        elif PART_MARK in item:
            del item[PART_MARK]
        item.update_tag()
    return len(marked)


def mark_room(
    scene: bpy.types.Scene, kind: str, floor_point: NDArray[np.float64], units: float, marker: bpy.types.Object | None
) -> bpy.types.Object | None:
    """Say what a room is, "none" for no room, "" to take back what was said: by a ``marker`` or, without, a new Empty.

    ``floor_point`` (3,) metres is on the floor of the room; ``units`` are those of the scene in a metre.
    """
    if not kind:
        if marker is not None:
            _forget(marker)
        return None
    name = "No Room" if kind == NO_ROOM else kind.title()
    if marker is None:
        marker = bpy.data.objects.new(name, None)
        marker.empty_display_type, marker.empty_display_size = "SPHERE", SIZE * units
        marker.location = (floor_point + np.array([0, 0, HIGH])) * units
        scene.collection.objects.link(marker)
        ensure_uid(marker)
    elif _is_own(marker):
        marker.name = name
    marker[ROOM_MARK] = kind
    marker.update_tag()
    return marker


def _forget(marker: bpy.types.Object) -> None:
    if _is_own(marker):
        bpy.data.objects.remove(marker)
    else:
        del marker[ROOM_MARK]
        marker.update_tag()


def _is_own(marker: bpy.types.Object) -> bool:
    """Whether an object is an Empty that stands there for nothing but its mark."""
    return marker.type == "EMPTY" and not marker.children and set(marker.keys()) <= {ROOM_MARK, UID}
