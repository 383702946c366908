"""What panels and grey buttons ask of a scene, looked up once until something in it changes: they are drawn often."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import bpy
from bpy.app.handlers import persistent

if TYPE_CHECKING:
    from ..unisg_blender.scene.action_data import ActionData


class SceneLookup:
    """Names and values of one scene; no Blender objects, which undo would leave dangling."""

    def __init__(self, scene: bpy.types.Scene) -> None:
        self.scene, self.count = scene.name, len(scene.objects)

    @cached_property
    def names(self) -> dict[str, str]:
        """Names of the objects by uid."""
        from ..unisg_blender.blender.lookup import objects_by_uid

        return {uid: item.name for uid, item in objects_by_uid(bpy.data.scenes[self.scene]).items()}

    @cached_property
    def actions(self) -> dict[str, tuple[ActionData, str]]:
        """Actions by uid, with the names of the objects that they belong to."""
        from ..unisg_blender.blender.authoring.authoring import scene_actions

        return {action.uid: (action, item.name) for item, action in scene_actions(bpy.data.scenes[self.scene])}

    @cached_property
    def categories(self) -> set[str]:
        """What there is."""
        return {str(item["unisg_category"]) for item in bpy.data.scenes[self.scene].objects if "unisg_category" in item}

    @cached_property
    def lessons(self) -> list[str]:
        """Names of the objects that stand for operations."""
        from ..unisg_blender.blender.authoring.authoring import lesson_objects

        return [item.name for item in lesson_objects(bpy.data.scenes[self.scene])]


_looked_up: dict[str, SceneLookup] = {}


def looked_up(scene: bpy.types.Scene) -> SceneLookup:
    """What was looked up in a scene since it changed."""
    found = _looked_up.get(scene.name)
    if found is None or found.count != len(scene.objects):
        found = _looked_up[scene.name] = SceneLookup(scene)
    return found


@persistent
def _forget(*_: object) -> None:
    _looked_up.clear()


CLASSES = ()
HANDLERS = tuple((name, _forget) for name in ("depsgraph_update_post", "undo_post", "redo_post", "load_post"))
