"""Lock Blender objects, so that nothing moves them but the user."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ...scene.structure_marks import LOCK, is_lock


def is_locked(item: bpy.types.Object) -> bool:
    """Whether an object is locked."""
    return is_lock(item.get(LOCK, ""))


def set_locked(objects: Iterable[bpy.types.Object], locked: bool) -> int:
    """Lock objects, or set them free; linked ones are passed over. Returns the number of objects that were changed."""
    changed = [item for item in objects if item.library is None and is_locked(item) != locked]
    for item in changed:
        if locked:
            item[LOCK] = "yes"
        else:
            del item[LOCK]
    return len(changed)
