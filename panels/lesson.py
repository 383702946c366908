"""The lesson: play it, see its tree, change the active node."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ..operators.interchange.play_in_browser import served_address
from ..operators.lesson_properties import active_node, lesson_object, shown_top
from ..operators.play import session
from ..operators.scene_lookup import looked_up
from .main import LessonPanel, draw_text

if TYPE_CHECKING:
    from ..unisg_blender.blender.viewport.lesson_session import Session
    from ..unisg_blender.scene.action_data import ActionData
    from ..unisg_blender.scene.lesson_node import LessonNode

KIND_ICONS = {"operation": "SCENE_DATA", "lesson": "BOOKMARKS", "stage": "SEQUENCE", "action": "DOT"}
INSET = 24
"""Pixels of a sidebar's width that a box and an icon take."""

GREEN, ORANGE = "COLORSET_03_VEC", "COLORSET_02_VEC"
STATUS_ICONS = {"waiting": "RADIOBUT_OFF", "open": "PLAY", "done": "CHECKMARK", "skipped": "REMOVE"}


class UNISG_PT_play(LessonPanel):
    """Play the lesson and hear what happens."""

    bl_label = "Play"

    def draw(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.authoring.stored_behaviour import lesson_of

        layout, current = self.layout, session()
        if current is None:
            item = lesson_object(context)
            root = None if item is None else lesson_of(item)
            row = layout.row(align=True)
            row.operator("unisg.play", icon="PLAY").operation = "" if root is None else root.uid
            row.operator("unisg.play_in_browser", icon="WORLD")
            if served_address():
                row = layout.row()
                row.label(text=served_address(), icon="INFO")
                row.operator("unisg.browser_stop", text="", icon="X")
            return
        layout.operator("unisg.play_stop", icon="SNAP_FACE")
        if current.state.finished:
            layout.label(text="Played to the end", icon="CHECKMARK")
        for action, holds in current.open_actions():
            _open_action(layout, current, action, holds, context.region.width)
        told = current.message()
        if told is not None:
            text = told.why if told.kind != "done" else f"Done: {told.name}"
            column = layout.column()
            column.alert = told.kind != "done"
            draw_text(column, text, context.region.width)


def _open_action(layout: bpy.types.UILayout, current: Session, action: ActionData, holds: bool, width: int) -> None:
    """What is to be done, in full, with buttons for what is not done by moving things."""
    box = layout.box().column(align=True)
    draw_text(box, action.name or action.type, width - INSET, GREEN if holds else ORANGE)
    graph = current.lesson.graph
    if action.type == "Question":
        several = len(action.correct) > 1
        for place, answer in enumerate(action.answers):
            ticked = place in current.chosen.get(action.uid, ())
            choose = box.operator("unisg.play_choose", text=answer, depress=ticked)
            choose.uid, choose.place, choose.several = action.uid, place, several
        if several:
            box.operator("unisg.play_answer").uid = action.uid
    elif action.trigger or action.type == "Tool":
        for uid in action.tools:
            name = graph.name[graph.row_of_uid[uid]]
            pressed = uid in current.pressed
            box.operator("unisg.play_trigger", text=f"Trigger of {name}", depress=pressed).uid = uid


class UNISG_PT_lesson(LessonPanel):
    """The tree of the lesson."""

    bl_label = "Parts and Order"

    def draw(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.authoring.stored_behaviour import lesson_of, why_fixed
        from ..unisg_blender.scene.properties import LSA

        layout, item, active = self.layout, lesson_object(context), active_node(context)
        root = None if item is None else lesson_of(item)
        if item is None or root is None or active is None:
            layout.label(text="No lesson yet", icon="INFO")
            layout.operator("unisg.lesson_new", icon="ADD")
            return
        row = layout.row(align=True)
        if len(looked_up(context.scene).lessons) > 1:
            row.prop_search(
                context.window_manager, "unisg_lesson", context.scene, "objects", text="", icon="EMPTY_DATA"
            )
        else:
            row.label(text=item.name, icon="EMPTY_DATA")
        row.operator("unisg.lesson_new", text="", icon="ADD")
        row.operator("unisg.lesson_check", text="", icon="CHECKMARK")
        reason = why_fixed(item, LSA)
        if reason:
            draw_text(layout, reason, context.region.width)
        row = layout.split(factor=0.88)
        tree = row.column(align=True)
        tree.scale_y = 0.9
        top = shown_top(root)
        _tree(tree, top, 0, active.uid)
        buttons = row.column(align=True)
        buttons.operator_menu_enum("unisg.lesson_add", "kind", text="", icon="ADD")
        buttons.operator("unisg.lesson_remove", text="", icon="REMOVE")
        for how, icon in (("UP", "TRIA_UP"), ("DOWN", "TRIA_DOWN"), ("IN", "TRIA_RIGHT"), ("OUT", "TRIA_LEFT")):
            buttons.operator("unisg.lesson_move", text="", icon=icon).how = how
        layout.operator("unisg.lesson_add_action", icon="ADD")
        _node(layout, item, root, active)


def _tree(layout: bpy.types.UILayout, node: LessonNode, depth: int, active: str) -> None:
    current = session()
    line = layout.row(align=True)
    line.alignment = "LEFT"
    if depth:
        indent = line.row()
        indent.ui_units_x = 0.6 * depth
        indent.label(text="")
    icon = STATUS_ICONS[current.status(node.uid)] if current is not None else KIND_ICONS[node.kind]
    text = (node.name or node.kind) + (" (optional)" if node.optional else "")
    text += " (any order)" if node.children and not node.ordered else ""
    chosen = line.operator(
        "unisg.lesson_select", text=text, icon=icon, depress=node.uid == active, emboss=node.uid == active
    )
    chosen.uid = node.uid
    for child in node.children:
        _tree(layout, child, depth + 1, active)


def _node(layout: bpy.types.UILayout, item: bpy.types.Object, root: LessonNode, node: LessonNode) -> None:
    box = layout.box().column()
    kind = node.kind.capitalize()
    box.prop(item, "unisg_node_name", text="", icon=KIND_ICONS[node.kind], placeholder=kind)
    row = box.row()
    if node.uid != root.uid:
        row.prop(item, "unisg_node_optional")
    if node.kind != "action":
        row.prop(item, "unisg_node_ordered")
    names = {each.uid: each.name or each.kind for each in root.walk()}
    for uid in node.requires:
        row = box.row(align=True)
        row.label(text=f"after {names.get(uid, uid)}", icon="LINKED")
        row.operator("unisg.lesson_unrequire", text="", icon="X", emboss=False).uid = uid
    if node.uid != root.uid:
        box.operator("unisg.lesson_require", icon="ADD")


CLASSES = (UNISG_PT_play, UNISG_PT_lesson)
