"""Tell copies apart as soon as they are made, while it is plain what was copied together."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

_seen: dict[str, int] = {}
_grown: set[str] = set()
"""Scenes by name, how many objects each had, and which of them have more now."""


@persistent
def _after_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    count = len(scene.objects)
    grown = count > _seen.get(scene.name, count)
    _seen[scene.name] = count
    if not grown:
        return
    _grown.add(scene.name)
    if not bpy.app.timers.is_registered(_repair):
        bpy.app.timers.register(_repair, first_interval=0)  # handlers must not write to the scene, timers may


@persistent
def _forget(*_: object) -> None:
    _seen.clear()
    _grown.clear()


def _repair() -> None:
    from ..unisg_blender.blender.authoring.identities import repair_copies

    for name in _grown & set(bpy.data.scenes.keys()):  # each window may show another scene
        repair_copies(bpy.data.scenes[name])
    _grown.clear()


HANDLERS = (("depsgraph_update_post", _after_update), ("load_post", _forget))
CLASSES = ()


def unregister() -> None:
    """Forget what was seen."""
    if bpy.app.timers.is_registered(_repair):
        bpy.app.timers.unregister(_repair)
    _forget()
