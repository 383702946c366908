"""Which lesson and which of its nodes the panel shows, and that node's fields as Blender properties."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import bpy

CLASSES: tuple = ()


def lesson_object(context: bpy.types.Context) -> bpy.types.Object | None:
    """The object whose lesson is shown: the chosen one, else the active one, else the first of the scene."""
    from ..unisg_blender.blender.authoring.authoring import lesson_objects

    found = lesson_objects(context.scene)
    chosen = [item for item in found if item.name == context.window_manager.unisg_lesson]
    return next(iter([*chosen, *(item for item in found if item == context.active_object), *found]), None)


def active_node(context: bpy.types.Context) -> Any:
    """The active node of the shown lesson, the operation itself by default; None without a lesson."""
    from ..unisg_blender.behaviour.lesson.edit import find
    from ..unisg_blender.blender.authoring.stored_behaviour import lesson_of

    item = lesson_object(context)
    root = lesson_of(item) if item is not None else None
    return root and (find(root, context.window_manager.unisg_lesson_node) or root)


def _node_property(name: str, default: Any) -> tuple[Callable[..., Any], Callable[..., None]]:
    def get(item: bpy.types.Object) -> Any:
        node = active_node(bpy.context)
        return default if node is None else getattr(node, name)

    def set_value(item: bpy.types.Object, value: Any) -> None:
        from ..unisg_blender.behaviour.lesson.edit import change
        from ..unisg_blender.blender.authoring.authoring import change_lesson
        from ..unisg_blender.errors import UniSGError

        node = active_node(bpy.context)
        try:
            change_lesson(item, lambda root: change(root, node.uid, lambda each: replace(each, **{name: value})))
        except UniSGError as error:  # a property cannot report; the panel says why it is grey
            print(f"UniSG: {error}")

    return get, set_value


def register() -> None:
    """Add the properties of the active node, stored in the lesson itself."""
    props, manager, item = bpy.props, bpy.types.WindowManager, bpy.types.Object
    manager.unisg_lesson = props.StringProperty(name="Lesson", options={"SKIP_SAVE"})
    manager.unisg_lesson_node = props.StringProperty(options={"SKIP_SAVE"})
    read, write = _node_property("name", "")
    item.unisg_node_name = props.StringProperty(
        name="Name", description="What this part of the lesson is called", get=read, set=write
    )
    read, write = _node_property("optional", False)
    item.unisg_node_optional = props.BoolProperty(
        name="Optional", description="The lesson can be finished without it", get=read, set=write
    )
    read, write = _node_property("ordered", True)
    item.unisg_node_ordered = props.BoolProperty(
        name="In This Order", description="What it holds has to be done one after another", get=read, set=write
    )


def unregister() -> None:
    """Take the properties away."""
    for name in ("unisg_lesson", "unisg_lesson_node"):
        delattr(bpy.types.WindowManager, name)
    for name in ("unisg_node_name", "unisg_node_optional", "unisg_node_ordered"):
        delattr(bpy.types.Object, name)
