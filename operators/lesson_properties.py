"""Which lesson and which of its nodes the panel shows, and that node's fields as Blender properties."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import bpy

from ..unisg_blender.errors import UniSGError
from .scene_lookup import looked_up

if TYPE_CHECKING:
    from ..unisg_blender.scene.lesson_node import LessonNode


def lesson_object(context: bpy.types.Context) -> bpy.types.Object | None:
    """The object whose lesson is shown: the chosen one, else the active one, else the first of the scene."""
    found = looked_up(context.scene).lessons
    item = getattr(context, "active_object", None)  # Blender asks without a window too, where it makes overrides
    active = "" if item is None else item.name
    preferred = [name for name in (context.window_manager.unisg_lesson, active) if name in found]
    return context.scene.objects.get(next(iter([*preferred, *found]), ""))


def shown_top(root: LessonNode) -> LessonNode:
    """What the tree begins with: an operation with one lesson only is that lesson, to a user."""
    return root.children[0] if root.kind == "operation" and len(root.children) == 1 else root


def active_node(context: bpy.types.Context) -> LessonNode | None:
    """The active node of the shown lesson, the top of what is shown by default; None without a lesson."""
    from ..unisg_blender.behaviour.lesson.edit import find
    from ..unisg_blender.blender.authoring.stored_behaviour import lesson_of

    item = lesson_object(context)
    root = lesson_of(item) if item is not None else None
    return root and (find(root, context.window_manager.unisg_lesson_node) or shown_top(root))


def _field(name: str, default: Any) -> dict[str, Callable[..., Any]]:
    """The two functions that read and write a field of the active node."""

    def get(item: bpy.types.Object) -> Any:
        node = active_node(bpy.context)
        return default if node is None else getattr(node, name)

    def set_value(item: bpy.types.Object, value: Any) -> None:
        from ..unisg_blender.behaviour.lesson.edit import change
        from ..unisg_blender.blender.authoring.authoring import change_lesson

        node = active_node(bpy.context)
        if node is None:
            return
        try:
            change_lesson(item, lambda root: change(root, node.uid, lambda each: replace(each, **{name: value})))
        except UniSGError as error:  # a property cannot report; the panel says why it is grey
            print(f"UniSG: {error}")

    return {"get": get, "set": set_value}


CLASSES = ()
PROPERTIES = (
    (bpy.types.WindowManager, "unisg_lesson", bpy.props.StringProperty(name="Lesson", options={"SKIP_SAVE"})),
    (bpy.types.WindowManager, "unisg_lesson_node", bpy.props.StringProperty(options={"SKIP_SAVE"})),
    (bpy.types.Object, "unisg_node_name", bpy.props.StringProperty(
        name="Name", description="What this part of the lesson is called", **_field("name", ""),
    )),
    (bpy.types.Object, "unisg_node_optional", bpy.props.BoolProperty(
        name="Optional", description="The lesson can be finished without it", **_field("optional", False),
    )),
    (bpy.types.Object, "unisg_node_ordered", bpy.props.BoolProperty(
        name="In This Order", description="What it holds has to be done one after another", **_field("ordered", True),
    )),
)  # fmt: skip
"""The properties of the active node are stored in the lesson itself."""
