"""Tell copies apart as soon as they are made, while it is plain what was copied together."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

_seen: dict[str, int] = {}


@persistent
def _after_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    count = len(scene.objects)
    grown = count > _seen.get(scene.name, count)
    _seen[scene.name] = count
    if grown and not bpy.app.timers.is_registered(_repair):
        bpy.app.timers.register(_repair, first_interval=0)  # handlers must not write to the scene, timers may


@persistent
def _forget(*_: object) -> None:
    _seen.clear()


def _repair() -> None:
    from ..unisg_blender.blender.authoring.identities import repair_copies

    repair_copies(bpy.context.scene)


HANDLERS = (("depsgraph_update_post", _after_update), ("load_post", _forget))
CLASSES = ()


def unregister() -> None:
    """Forget what was seen."""
    if bpy.app.timers.is_registered(_repair):
        bpy.app.timers.unregister(_repair)
    _seen.clear()
