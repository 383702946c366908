"""Check the scene: what collides, floats, stands outside or before a door; and go to what is wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from bpy.app.handlers import persistent

from ...unisg_blender.errors import UniSGError
from ..base import Operator, redraw_views
from .background import Background

if TYPE_CHECKING:
    from ...unisg_blender.generate.check.scene_check import SceneCheck
    from ...unisg_blender.scene import SceneGraph

_background: Background[tuple[SceneGraph, SceneCheck]] = (
    Background()
)  # `Background[...]()` would be kept by typing, see there


class UNISG_Fault(bpy.types.PropertyGroup):
    """What is wrong with an object; ``name`` is that of the object."""

    uid: bpy.props.StringProperty()
    state: bpy.props.StringProperty()
    text: bpy.props.StringProperty()


class UNISG_CheckedScene(bpy.types.PropertyGroup):
    """What the last check of a scene found."""

    scene: bpy.props.StringProperty()
    summary: bpy.props.StringProperty()
    faults: bpy.props.CollectionProperty(type=UNISG_Fault)
    active: bpy.props.IntProperty()


def checking() -> bool:
    """Whether a check is going on."""
    return _background.busy


class UNISG_OT_check(Operator):
    """List what collides, floats, is outside the building or blocks a door, and by how much; nothing is changed"""

    bl_idname = "unisg.check"
    bl_label = "Check Scene"
    bl_options = {"REGISTER"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        if checking():
            return "The scene is being checked"
        return "" if any(item.type == "MESH" for item in context.scene.objects) else "The scene has no meshes"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return self.reporting(self._start, context)

    def _start(self, context: bpy.types.Context) -> set[str]:
        graph, scene = _read(context.scene), context.scene.name
        _background.start(
            lambda: _checked(graph), lambda found: _list(scene, *found), lambda text: _say(scene, text)
        )  # fmt: skip
        _say(scene, "Checking ...")
        return {"FINISHED"}

    def run(self, context: bpy.types.Context) -> None:
        graph, found = _checked(_read(context.scene))
        _list(context.scene.name, graph, found)
        self.report({"WARNING" if found.faults else "INFO"}, found.summary)


def _read(scene: bpy.types.Scene) -> SceneGraph:
    from ...unisg_blender.blender import read_scene

    return read_scene(scene, details=False)


def _checked(graph: SceneGraph) -> tuple[SceneGraph, SceneCheck]:
    from ...unisg_blender.generate.check.scene_check import check_scene

    return graph, check_scene(graph)


def _say(scene: str, text: str) -> None:
    settings = bpy.context.window_manager.unisg_check
    settings.faults.clear()
    settings.scene, settings.summary = scene, text


def _list(scene: str, graph: SceneGraph, found: SceneCheck) -> None:
    _say(scene, found.summary)
    for fault in found.faults:
        item = bpy.context.window_manager.unisg_check.faults.add()
        item.name, item.uid, item.state, item.text = (
            graph.name[fault.row],
            graph.uid[fault.row],
            fault.state,
            fault.text,
        )
    redraw_views(bpy.context)


class UNISG_OT_show_object(Operator):
    """Select this object and bring it into view"""

    bl_idname = "unisg.show_object"
    bl_label = "Show Object"
    bl_options = {"REGISTER", "UNDO"}

    uid: bpy.props.StringProperty(name="Identity", description="UniSG identity of the object")
    text: bpy.props.StringProperty(name="Text", description="What is wrong with it", options={"SKIP_SAVE", "HIDDEN"})

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """The tooltip: the whole text, which the list may cut off."""
        return f"{properties.text}. Select it and bring it into view" if properties.text else str(cls.__doc__)

    def run(self, context: bpy.types.Context) -> None:
        items = _found(context, [self.uid])
        if not items:
            raise UniSGError("the object is no longer there, or is hidden: check again")
        _select(context, items)
        area = context.area
        region = None if area is None else next((part for part in area.regions if part.type == "WINDOW"), None)
        if area is not None and area.type == "VIEW_3D" and region is not None:
            with context.temp_override(area=area, region=region):
                bpy.ops.view3d.view_selected()


class UNISG_OT_select_faults(Operator):
    """Select all objects of the list, to settle or move them"""

    bl_idname = "unisg.select_faults"
    bl_label = "Select All"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if len(context.window_manager.unisg_check.faults) else "The list is empty: check the scene first"

    def run(self, context: bpy.types.Context) -> None:
        items = _found(context, [fault.uid for fault in context.window_manager.unisg_check.faults])
        _select(context, items)
        self.report({"INFO"}, f"{len(items)} objects selected")


def _found(context: bpy.types.Context, uids: list[str]) -> list[bpy.types.Object]:
    """The objects with some uids that can be selected."""
    from ...unisg_blender.blender import objects_by_uid

    items = objects_by_uid(context.scene)
    return [items[uid] for uid in uids if uid in items and items[uid].visible_get()]


def _select(context: bpy.types.Context, items: list[bpy.types.Object]) -> None:
    """Select objects with the meshes under them; the first one is active."""
    for item in context.selected_objects:
        item.select_set(False)
    for item in items:
        for part in (item, *item.children_recursive) if item.type == "EMPTY" else (item,):
            part.select_set(True)
    if items:
        context.view_layer.objects.active = items[0]


@persistent
def _loaded(*_: object) -> None:
    _background.end()
    _say("", "")


CLASSES = (UNISG_Fault, UNISG_CheckedScene, UNISG_OT_check, UNISG_OT_show_object, UNISG_OT_select_faults)
HANDLERS = (("load_post", _loaded),)
PROPERTIES = ((bpy.types.WindowManager, "unisg_check", bpy.props.PointerProperty(type=UNISG_CheckedScene)),)


def unregister() -> None:
    """Let a check go that is going on."""
    _background.end()
