"""The active object's actions: the list, and the fields of the active one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ..operators.action_properties import ANSWERS, TYPES, active_place, readable_actions, type_items
from ..operators.scene_lookup import looked_up
from ..unisg_blender.errors import UniSGError
from .main import LessonPanel, draw_text

if TYPE_CHECKING:
    from ..unisg_blender.scene.action_data import ActionData

ICONS = {
    "Insert": "IMPORT", "Remove": "EXPORT", "Use": "HAND", "Tool": "TOOL_SETTINGS", "Question": "QUESTION",
    "Parallel": "OUTLINER",
}  # fmt: skip
LIMITS: dict[str, tuple[str, ...]] = {
    "Insert": ("distance", "angle", "hold"),
    "Remove": ("distance", "angle", "hold"),
    "Use": ("distance", "hold", "hits", "force"),
    "Tool": ("distance", "angle", "hold", "hits", "force"),
    "Question": (),
    "Parallel": (),
}
OWN_LIMITS = LIMITS["Tool"]
"""A type of the user's own may ask for anything."""


class UNISG_PT_actions(LessonPanel):
    """What has to happen to the active object."""

    bl_label = "Actions"

    def draw(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.authoring.stored_behaviour import actions_of, why_fixed

        layout, item = self.layout, context.active_object
        if item is None:
            layout.label(text="Select an object to give it actions", icon="INFO")
            return
        try:
            actions_of(item)
            reason = why_fixed(item)
        except UniSGError as error:
            reason = str(error)
        if reason:
            draw_text(layout, reason, context.region.width)
        body = layout.column()
        body.enabled = not reason
        _list(body, context, item)
        actions, place = readable_actions(item), active_place(context, item)
        if place >= 0:
            _fields(body, context, item, actions[place])


def _list(layout: bpy.types.UILayout, context: bpy.types.Context, item: bpy.types.Object) -> None:
    active = active_place(context, item)
    row = layout.split(factor=0.88)
    names = row.column(align=True)
    for place, action in enumerate(readable_actions(item)):
        line = names.row(align=True)
        line.alignment = "LEFT"
        chosen = line.operator(
            "unisg.action_select", text=action.name or action.type, icon=ICONS.get(action.type, "DOT"),
            depress=place == active, emboss=place == active,
        )  # fmt: skip
        chosen.place = place
    if not readable_actions(item):
        names.label(text="No actions yet")
    buttons = row.column(align=True)
    buttons.operator_menu_enum("unisg.action_add", "type", text="", icon="ADD")
    if active >= 0:
        buttons.operator("unisg.action_remove", text="", icon="REMOVE")
        buttons.operator("unisg.action_duplicate", text="", icon="DUPLICATE")
        buttons.operator("unisg.action_move", text="", icon="TRIA_UP").step = -1
        buttons.operator("unisg.action_move", text="", icon="TRIA_DOWN").step = 1
    buttons.separator()
    buttons.operator("unisg.load_types", text="", icon="FILE_SCRIPT")


def _fields(layout: bpy.types.UILayout, context: bpy.types.Context, item: bpy.types.Object, action: ActionData) -> None:
    column = layout.column()
    column.use_property_split, column.use_property_decorate = True, False
    column.prop(item, "unisg_action_name")
    if action.type in TYPES:
        column.prop(item, "unisg_action_type")
    else:
        known = action.type in {name for name, _, _ in type_items(None, context)}
        text = f"{action.type}: a type of your own" if known else f"{action.type}: unknown, load its file"
        column.label(text=text, icon="SCRIPT" if known else "ERROR")
    own = action.type not in TYPES
    limits = OWN_LIMITS if own else LIMITS[action.type]
    if limits:
        _objects(layout, context, action, "targets", "Target")
    if own or action.type in ("Use", "Tool"):
        _objects(layout, context, action, "tools", "Tool")
        if action.type != "Tool":
            layout.prop(item, "unisg_action_trigger")
    if own or action.type in ("Insert", "Remove", "Tool"):
        _reference(layout, context, action)
    for name in limits:
        _limit(layout, item, action, name)
    if action.type == "Question":
        _answers(layout, item, action)
    if action.type == "Parallel":
        _members(layout, context, item, action)


def _objects(layout: bpy.types.UILayout, context: bpy.types.Context, action: ActionData, slot: str, title: str) -> None:
    names, uids = looked_up(context.scene).names, getattr(action, slot)
    box = layout.box().column(align=True)
    box.label(text=f"{title}: any of these" if len(uids) > 1 else title)
    for uid in uids:
        _linked(box, action, slot, uid, names.get(uid))
    row = box.row(align=True)
    row.prop(context.window_manager, f"unisg_pick_{slot}", text="")
    row.operator("unisg.action_link", text="", icon="RESTRICT_SELECT_OFF").slot = slot


def _linked(
    box: bpy.types.UILayout, action: ActionData, slot: str, uid: str, name: str | None, icon: str = "OBJECT_DATA"
) -> None:
    """A row for something that an action refers to, with a button that takes it out; no name: it is missing."""
    row = box.row(align=True)
    missing = f"{action.names.get(uid, uid)} (missing)"
    row.label(text=missing if name is None else name, icon="ERROR" if name is None else icon)
    out = row.operator("unisg.action_unlink", text="", icon="X", emboss=False)
    out.slot, out.uid = slot, uid


def _reference(layout: bpy.types.UILayout, context: bpy.types.Context, action: ActionData) -> None:
    box = layout.box().column(align=True)
    missing = {"Insert": "none yet", "Remove": "from where it stands now", "Tool": "none: contact"}
    without = missing.get(action.type, "none")
    box.label(text="Reference pose" if action.reference else f"Reference pose: {without}")
    row = box.row(align=True)
    row.operator("unisg.action_reference", text="From Current Pose", icon="PINNED")
    row.operator("unisg.action_go_to_reference", text="", icon="VIEWZOOM")
    if action.frame:
        name = looked_up(context.scene).names.get(action.frame)
        _linked(box, action, "frame", action.frame, name and f"moves with {name}", "LINKED")
    else:
        row = box.row(align=True)
        row.label(text="moves with", icon="UNLINKED")
        row.prop(context.window_manager, "unisg_pick_frame", text="")


def _limit(layout: bpy.types.UILayout, item: bpy.types.Object, action: ActionData, name: str) -> None:
    row = layout.row(align=True)
    row.prop(item, f"unisg_action_ask_{name}", text="")
    field = row.row()
    field.enabled = getattr(action.thresholds, name) is not None
    field.prop(item, f"unisg_action_{name}")


def _answers(layout: bpy.types.UILayout, item: bpy.types.Object, action: ActionData) -> None:
    box = layout.box().column(align=True)
    row = box.row()
    row.label(text="Answers; tick the right ones")
    row.operator("unisg.action_answers", text="", icon="ADD").add = True
    row.operator("unisg.action_answers", text="", icon="REMOVE").add = False
    for place in range(min(len(action.answers), ANSWERS)):
        row = box.row(align=True)
        row.prop(item, f"unisg_action_correct_{place}", text="")
        row.prop(item, f"unisg_action_answer_{place}", text="")


def _members(
    layout: bpy.types.UILayout, context: bpy.types.Context, item: bpy.types.Object, action: ActionData
) -> None:
    found = looked_up(context.scene).actions if action.members else {}
    box = layout.box().column(align=True)
    box.prop(item, "unisg_action_any")
    for uid in action.members:
        if uid in found:
            member, owner = found[uid]
            name, icon = f"{member.name or member.type} ({owner})", ICONS.get(member.type, "DOT")
            _linked(box, action, "members", uid, name, icon)
        else:
            _linked(box, action, "members", uid, None)
    box.operator("unisg.action_member", icon="ADD")


CLASSES = (UNISG_PT_actions,)
