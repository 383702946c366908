"""From uids to Blender objects: operators hold uids, never objects, across undo and redraw."""

from __future__ import annotations

import bpy

from ..scene.identity import resolve_uids
from ..scene.properties import UID

IMPORTED_UID = "unisg:uid"
"""Where Blender's own USD importer puts it."""


def stored_uid(owner: bpy.types.Object) -> str:
    """The uid that an object carries, "" for none."""
    value = owner.get(UID) or owner.get(IMPORTED_UID)
    return value.strip() if isinstance(value, str) else ""


def objects_by_uid(scene: bpy.types.Scene) -> dict[str, bpy.types.Object]:
    """Every object of the scene under the uid that :func:`~.read.scene_reader.read_scene` gives it."""
    objects = list(scene.objects)
    uids = resolve_uids([stored_uid(item) for item in objects], [item.name for item in objects])
    return dict(zip(uids, objects, strict=True))
