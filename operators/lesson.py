"""Build lessons: which actions, in which order, what has to come before what."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import bpy

from ..unisg_blender.errors import UniSGError
from .action_properties import active_action, readable_actions
from .base import Operator, SearchOperator, redraw_views, select_only
from .lesson_properties import active_node, lesson_object

if TYPE_CHECKING:
    from ..unisg_blender.scene.lesson_node import LessonNode

NO_LESSON = "The scene has no lesson: add one"
KIND_ITEMS = (
    ("lesson", "Lesson", "A part that holds stages or further lessons"),
    ("stage", "Stage", "A part that holds actions"),
)


class LessonOperator(Operator):
    """An operator on the shown lesson."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        from ..unisg_blender.blender.authoring.stored_behaviour import why_fixed
        from ..unisg_blender.scene.properties import LSA

        item = lesson_object(context)
        return why_fixed(item, LSA) if item is not None else NO_LESSON

    def edit(self, context: bpy.types.Context, root: LessonNode, node: LessonNode) -> LessonNode:
        """The lesson as it shall be; ``node`` is the active one."""
        raise NotImplementedError

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.authoring.authoring import change_lesson

        item, node = lesson_object(context), active_node(context)
        if item is None or node is None:
            raise UniSGError(NO_LESSON)
        change_lesson(item, lambda root: self.edit(context, root, node))
        redraw_views(context)


class UNISG_OT_lesson_new(Operator):
    """Add an Empty that stands for a lesson, with one stage to begin with"""

    bl_idname = "unisg.lesson_new"
    bl_label = "New Lesson"
    bl_options = {"REGISTER", "UNDO"}

    name: bpy.props.StringProperty(name="Name", default="Lesson", options={"SKIP_SAVE"})

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if context.mode == "OBJECT" else "Go to object mode first"

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.authoring.authoring import new_lesson
        from ..unisg_blender.blender.authoring.stored_behaviour import lesson_of

        made = new_lesson(context.scene, self.name)
        context.window_manager.unisg_lesson = made.name
        root = lesson_of(made)
        if root is not None:  # its stage takes the next actions
            context.window_manager.unisg_lesson_node = next(node.uid for node in root.walk() if node.kind == "stage")


class UNISG_OT_lesson_add(LessonOperator):
    """Add a lesson or a stage: inside the active node, or beside it"""

    bl_idname = "unisg.lesson_add"
    bl_label = "Add Part"

    kind: bpy.props.EnumProperty(name="Kind", items=KIND_ITEMS, default="stage")

    def edit(self, context: bpy.types.Context, root: LessonNode, node: LessonNode) -> LessonNode:
        from ..unisg_blender.behaviour.lesson.edit import insert, new_node, parent_of
        from ..unisg_blender.scene.lesson_node import MAY_HOLD

        made = new_node(self.kind, self.kind.capitalize())
        above: LessonNode | None = node
        after: LessonNode | None = None
        while above is not None and self.kind not in MAY_HOLD[above.kind]:
            above, after = parent_of(root, above.uid), above
        if above is None:  # a stage beside the operation: into its last lesson
            above, after = root.children[-1] if root.children else root, None
        place = None if after is None else [each.uid for each in above.children].index(after.uid) + 1
        context.window_manager.unisg_lesson_node = made.uid
        return insert(root, above.uid, made, place)


class UNISG_OT_lesson_add_action(LessonOperator):
    """Let the lesson perform the active object's active action: behind the active node, or in the last stage"""

    bl_idname = "unisg.lesson_add_action"
    bl_label = "Add Active Action"

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        from ..unisg_blender.blender.authoring.stored_behaviour import lesson_of

        action = None if context.active_object is None else active_action(context, context.active_object)
        if action is None:
            return "Select an object that has an action"
        item = lesson_object(context)
        root = None if item is None else lesson_of(item)
        if root is not None and any(node.action == action.uid for node in root.walk()):
            return "The lesson has this action already"
        return super().why_grey(context)

    def edit(self, context: bpy.types.Context, root: LessonNode, node: LessonNode) -> LessonNode:
        from ..unisg_blender.behaviour.lesson.edit import insert, new_node, parent_of

        action = active_action(context, context.active_object)
        if action is None:
            raise UniSGError("select an object that has an action")
        made = new_node("action", action.name, action.uid)
        stages = [each for each in node.walk() if each.kind == "stage"]
        stages = stages or [each for each in root.walk() if each.kind == "stage"]
        stage = parent_of(root, node.uid) if node.kind == "action" else stages[-1] if stages else None
        if stage is None:
            raise UniSGError("the lesson has no stage yet: add one")
        place = [each.uid for each in stage.children].index(node.uid) + 1 if node.kind == "action" else None
        context.window_manager.unisg_lesson_node = made.uid
        return insert(root, stage.uid, made, place)


class UNISG_OT_lesson_remove(LessonOperator):
    """Remove the active node and all below it; actions stay with their objects"""

    bl_idname = "unisg.lesson_remove"
    bl_label = "Remove"

    def edit(self, context: bpy.types.Context, root: LessonNode, node: LessonNode) -> LessonNode:
        from ..unisg_blender.behaviour.lesson.edit import parent_of, remove

        above = parent_of(root, node.uid)
        left = remove(root, node.uid)
        context.window_manager.unisg_lesson_node = root.uid if above is None else above.uid
        return left


class UNISG_OT_lesson_move(LessonOperator):
    """Move the active node: up, down, into the part before it, or out of the part it is in"""

    bl_idname = "unisg.lesson_move"
    bl_label = "Move"

    how: bpy.props.EnumProperty(
        name="How",
        items=(("UP", "Up", "One place up"), ("DOWN", "Down", "One place down"), ("IN", "In", ""), ("OUT", "Out", "")),
    )

    def edit(self, context: bpy.types.Context, root: LessonNode, node: LessonNode) -> LessonNode:
        from ..unisg_blender.behaviour.lesson.edit import lift, move, nest

        if self.how in ("UP", "DOWN"):
            return move(root, node.uid, -1 if self.how == "UP" else 1)
        return nest(root, node.uid) if self.how == "IN" else lift(root, node.uid)


class UNISG_OT_lesson_select(Operator):
    """Make this the active node, and select what its action belongs to, and nothing else"""

    bl_idname = "unisg.lesson_select"
    bl_label = "Select"
    bl_options = {"UNDO", "INTERNAL"}

    uid: bpy.props.StringProperty(options={"HIDDEN"})

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.authoring.authoring import scene_actions

        context.window_manager.unisg_lesson_node = self.uid
        node = active_node(context)
        if node is None or not node.action:
            return
        for item, action in scene_actions(context.scene):
            if action.uid == node.action and item.name in context.view_layer.objects:
                select_only(context, [item])
                places = [each.uid for each in readable_actions(item)]
                context.window_manager.unisg_action = places.index(action.uid)
                return


_choices: list[tuple[str, str, str]] = []


def _other_nodes(self: object, context: bpy.types.Context) -> list[tuple[str, str, str]]:
    from ..unisg_blender.blender.authoring.stored_behaviour import lesson_of

    item, node = lesson_object(context), active_node(context)
    root = lesson_of(item) if item is not None else None
    related = {each.uid for each in node.walk()} if node is not None else set()
    nodes = list(root.walk())[1:] if root is not None else []
    _choices[:] = [(each.uid, each.name or each.kind, each.kind) for each in nodes if each.uid not in related]
    return _choices  # Blender needs the strings kept alive


class UNISG_OT_lesson_require(SearchOperator, LessonOperator):
    """Something that has to be done before the active node"""

    bl_idname = "unisg.lesson_require"
    bl_label = "Add Prerequisite"
    bl_property = "node"

    node: bpy.props.EnumProperty(name="Before", items=_other_nodes)

    def edit(self, context: bpy.types.Context, root: LessonNode, node: LessonNode) -> LessonNode:
        from ..unisg_blender.behaviour.lesson.edit import change

        wanted = (*dict.fromkeys((*node.requires, self.node)),)
        return change(root, node.uid, lambda each: replace(each, requires=wanted))


class UNISG_OT_lesson_unrequire(LessonOperator):
    """No longer wait for this"""

    bl_idname = "unisg.lesson_unrequire"
    bl_label = "Remove Prerequisite"

    uid: bpy.props.StringProperty(options={"HIDDEN"})

    def edit(self, context: bpy.types.Context, root: LessonNode, node: LessonNode) -> LessonNode:
        from ..unisg_blender.behaviour.lesson.edit import change

        left = tuple(uid for uid in node.requires if uid != self.uid)
        return change(root, node.uid, lambda each: replace(each, requires=left))


class UNISG_OT_lesson_check(Operator):
    """Look for everything that would keep the lesson from being played"""

    bl_idname = "unisg.lesson_check"
    bl_label = "Check Lesson"

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return NO_LESSON if lesson_object(context) is None else ""

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.behaviour import check_scene
        from ..unisg_blender.blender import read_scene

        problems = check_scene(read_scene(context.scene, geometry="none", details=False))
        for problem in problems:
            self.report({"ERROR" if problem.severe else "WARNING"}, problem.message)
        if not problems:
            self.report({"INFO"}, "The lesson is sound")


CLASSES = (
    UNISG_OT_lesson_new,
    UNISG_OT_lesson_add,
    UNISG_OT_lesson_add_action,
    UNISG_OT_lesson_remove,
    UNISG_OT_lesson_move,
    UNISG_OT_lesson_select,
    UNISG_OT_lesson_require,
    UNISG_OT_lesson_unrequire,
    UNISG_OT_lesson_check,
)
