"""Check the scene: what collides, floats, stands outside or before a door; and go to what is wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import mathutils
from bpy.app.handlers import persistent

from ..base import Operator, redraw_views, select_only
from .background import Background

if TYPE_CHECKING:
    from ...unisg_blender.generate.check.scene_check import SceneCheck
    from ...unisg_blender.scene import SceneGraph

SEEN, AROUND = 2.0, 2.0
"""From how far an object is looked at: so many times its diagonal, and so many metres more."""

_background: Background[tuple[SceneGraph, SceneCheck]] = (
    Background()
)  # `Background[...]()` would be kept by typing, see there


_stood: dict[str, mathutils.Matrix] = {}
"""Where each object stood when the scene was last looked at."""


class UNISG_Fault(bpy.types.PropertyGroup):
    """What is wrong with an object; ``name`` is that of the object."""

    uid: bpy.props.StringProperty()
    state: bpy.props.StringProperty()
    text: bpy.props.StringProperty()


def _chosen(listed: UNISG_CheckedScene, context: bpy.types.Context) -> None:
    """Select the object of the row that was clicked, and look at it; if it is gone, the list is old."""
    if not 0 <= listed.active < len(listed.faults) or context.mode != "OBJECT":
        return
    items = _found(context, [listed.faults[listed.active].uid])
    if not items:
        listed.old = True
        return
    _select(context, items)
    if context.area is not None and context.area.type == "VIEW_3D":
        _look_at(context.area.spaces.active.region_3d, context.selected_objects, _metre(context.scene))


class UNISG_CheckedScene(bpy.types.PropertyGroup):
    """What the last check of a scene found; ``old`` where something was moved since."""

    scene: bpy.props.StringProperty()
    old: bpy.props.BoolProperty()
    summary: bpy.props.StringProperty()
    faults: bpy.props.CollectionProperty(type=UNISG_Fault)
    active: bpy.props.IntProperty(
        name="Chosen", description="A click selects an object and shows it with what is around it", default=-1, min=-1,
        update=_chosen,
    )  # fmt: skip


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
        return self.reporting(_start, context.scene)

    def run(self, context: bpy.types.Context) -> None:
        graph, found = _checked(_read(context.scene))
        _list(context.scene.name, graph, found)
        self.report({"WARNING" if found.faults else "INFO"}, found.summary)


def check_again() -> None:
    """Look at what is listed anew, when Blender has finished what it does; without a window the list is emptied."""
    listed = bpy.context.window_manager.unisg_check
    if not listed.summary:
        return
    if bpy.app.background:
        _say("", "")
    else:
        _background.start_soon(listed.scene, _start, _say)


def _start(checked: bpy.types.Scene) -> set[str]:
    """Begin to check a scene in the background."""
    graph, scene = _read(checked), checked.name
    _background.start(
        lambda: _checked(graph), lambda found: _list(scene, *found), lambda text: _say(scene, text)
    )  # fmt: skip
    _say(scene, "Checking ...")
    return {"FINISHED"}


def _read(scene: bpy.types.Scene) -> SceneGraph:
    from ...unisg_blender.blender import read_scene

    graph = read_scene(scene, details=False)
    _stood.clear()
    _stood.update((item.name, item.matrix_world.copy()) for item in scene.objects)
    return graph


def _checked(graph: SceneGraph) -> tuple[SceneGraph, SceneCheck]:
    from ...unisg_blender.generate.check.scene_check import check_scene

    return graph, check_scene(graph)


def _say(scene: str, text: str) -> None:
    settings = bpy.context.window_manager.unisg_check
    settings.faults.clear()
    settings.scene, settings.summary, settings.active, settings.old = scene, text, -1, False


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


def _look_at(view: bpy.types.RegionView3D, items: list[bpy.types.Object], metre: float) -> None:
    """Have a viewport look at objects from where it does, far enough away to see what is around them."""
    corners = [item.matrix_world @ mathutils.Vector(corner) for item in items for corner in item.bound_box]
    ends = [mathutils.Vector([pick(point[axis] for point in corners) for axis in range(3)]) for pick in (min, max)]
    if view.view_perspective == "CAMERA":
        view.view_perspective = "PERSP"
    view.view_location = (ends[0] + ends[1]) / 2
    view.view_distance = SEEN * (ends[1] - ends[0]).length + AROUND * metre


def _metre(scene: bpy.types.Scene) -> float:
    """The scene's units in a metre."""
    from ...unisg_blender.blender.scene_units import metres_per_unit

    return 1.0 / metres_per_unit(scene)


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
    select_only(
        context,
        [part for item in items for part in ((item, *item.children_recursive) if item.type == "EMPTY" else (item,))],
    )


@persistent
def _changed(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph | None = None) -> None:
    """Say that the list is old, once."""
    listed = bpy.context.window_manager.unisg_check
    if not listed.summary or listed.old or listed.scene != scene.name or depsgraph is None:
        return
    if len(scene.objects) != len(_stood) or any(map(_is_changed, depsgraph.updates)):
        listed.old = True


def _is_changed(update: bpy.types.DepsgraphUpdate) -> bool:
    """Whether something has another shape or place; Blender tells of what was given an action or a name as well."""
    item = update.id
    if update.is_updated_geometry or not (update.is_updated_transform and isinstance(item, bpy.types.Object)):
        return bool(update.is_updated_geometry)
    return _stood.get(item.name) != item.matrix_world


@persistent
def _undone(*_: object) -> None:
    check_again()


@persistent
def _loaded(*_: object) -> None:
    _background.end()
    _say("", "")


CLASSES = (UNISG_Fault, UNISG_CheckedScene, UNISG_OT_check, UNISG_OT_select_faults)
HANDLERS = (
    ("depsgraph_update_post", _changed), ("undo_post", _undone), ("redo_post", _undone), ("load_post", _loaded),
)  # fmt: skip
PROPERTIES = ((bpy.types.WindowManager, "unisg_check", bpy.props.PointerProperty(type=UNISG_CheckedScene)),)


def unregister() -> None:
    """Let a check go that is going on."""
    _background.end()
    _stood.clear()
