"""Build lessons: which actions, in which order, what has to come before what."""

from __future__ import annotations

from dataclasses import replace

import bpy

from .action_properties import active_action
from .lesson_properties import active_node, lesson_object

KIND_ITEMS = (
    ("lesson", "Lesson", "A part that holds stages or further lessons"),
    ("stage", "Stage", "A part that holds actions"),
)


class LessonOperator:
    """An operator on the shown lesson; says why it is grey."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        from ..unisg_blender.blender.authoring.stored_behaviour import why_fixed
        from ..unisg_blender.scene.properties import LSA

        item = lesson_object(context)
        reason = why_fixed(item, LSA) if item is not None else "The scene has no lesson: add one"
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.authoring.authoring import change_lesson
        from ..unisg_blender.errors import UniSGError

        node = active_node(context)
        try:
            change_lesson(lesson_object(context), lambda root: self.edit(context, root, node))
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for area in context.screen.areas if context.screen else ():
            area.tag_redraw()
        return {"FINISHED"}


class UNISG_OT_lesson_new(bpy.types.Operator):
    """Add an Empty that stands for a lesson, with one stage to begin with"""

    bl_idname = "unisg.lesson_new"
    bl_label = "New Lesson"
    bl_options = {"REGISTER", "UNDO"}

    name: bpy.props.StringProperty(name="Name", default="Lesson")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode == "OBJECT":
            return True
        cls.poll_message_set("Go to object mode first")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.authoring.authoring import new_lesson

        context.window_manager.unisg_lesson = new_lesson(context.scene, self.name).name
        return {"FINISHED"}


class UNISG_OT_lesson_add(LessonOperator, bpy.types.Operator):
    """Add a lesson or a stage: inside the active node, or beside it"""

    bl_idname = "unisg.lesson_add"
    bl_label = "Add Part"

    kind: bpy.props.EnumProperty(name="Kind", items=KIND_ITEMS, default="stage")

    def edit(self, context, root, node):
        from ..unisg_blender.behaviour.lesson.edit import insert, new_node, parent_of
        from ..unisg_blender.scene.lesson_node import MAY_HOLD

        made = new_node(self.kind, self.kind.capitalize())
        above, after = node, None
        while above is not None and self.kind not in MAY_HOLD[above.kind]:
            above, after = parent_of(root, above.uid), above
        if above is None:  # a stage beside the operation: into its last lesson
            above = root.children[-1] if root.children else root
        place = None if after is None else [each.uid for each in above.children].index(after.uid) + 1
        context.window_manager.unisg_lesson_node = made.uid
        return insert(root, above.uid, made, place)


class UNISG_OT_lesson_add_action(LessonOperator, bpy.types.Operator):
    """Let the lesson perform the active object's active action: behind the active node, or in the last stage"""

    bl_idname = "unisg.lesson_add_action"
    bl_label = "Add Active Action"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.active_object is None or active_action(context, context.active_object) is None:
            cls.poll_message_set("Select an object that has an action")
            return False
        return super().poll(context)

    def edit(self, context, root, node):
        from ..unisg_blender.behaviour.lesson.edit import insert, new_node, parent_of
        from ..unisg_blender.errors import UniSGError

        action = active_action(context, context.active_object)
        made = new_node("action", action.name, action.uid)
        stages = [each for each in node.walk() if each.kind == "stage"]
        stages = stages or [each for each in root.walk() if each.kind == "stage"]
        if node.kind == "action":
            stage = parent_of(root, node.uid)
            place = [each.uid for each in stage.children].index(node.uid) + 1
        elif stages:
            stage, place = stages[-1], None
        else:
            raise UniSGError("the lesson has no stage yet: add one")
        context.window_manager.unisg_lesson_node = made.uid
        return insert(root, stage.uid, made, place)


class UNISG_OT_lesson_remove(LessonOperator, bpy.types.Operator):
    """Remove the active node and all below it; actions stay with their objects"""

    bl_idname = "unisg.lesson_remove"
    bl_label = "Remove"

    def edit(self, context, root, node):
        from ..unisg_blender.behaviour.lesson.edit import parent_of, remove

        above = parent_of(root, node.uid)
        left = remove(root, node.uid)
        context.window_manager.unisg_lesson_node = above.uid
        return left


class UNISG_OT_lesson_move(LessonOperator, bpy.types.Operator):
    """Move the active node: up, down, into the part before it, or out of the part it is in"""

    bl_idname = "unisg.lesson_move"
    bl_label = "Move"

    how: bpy.props.EnumProperty(
        name="How",
        items=(("UP", "Up", "One place up"), ("DOWN", "Down", "One place down"), ("IN", "In", ""), ("OUT", "Out", "")),
    )

    def edit(self, context, root, node):
        from ..unisg_blender.behaviour.lesson.edit import lift, move, nest

        if self.how in ("UP", "DOWN"):
            return move(root, node.uid, -1 if self.how == "UP" else 1)
        return nest(root, node.uid) if self.how == "IN" else lift(root, node.uid)


class UNISG_OT_lesson_select(bpy.types.Operator):
    """Make this the active node, and select what its action belongs to"""

    bl_idname = "unisg.lesson_select"
    bl_label = "Select"
    bl_options = {"INTERNAL"}

    uid: bpy.props.StringProperty()

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.authoring.authoring import scene_actions

        context.window_manager.unisg_lesson_node = self.uid
        node = active_node(context)
        for item, action in scene_actions(context.scene) if node is not None and node.action else ():
            if action.uid == node.action and item.name in context.view_layer.objects:
                context.view_layer.objects.active = item
                places = [each.uid for owner, each in scene_actions(context.scene) if owner == item]
                context.window_manager.unisg_action = places.index(action.uid)
                break
        return {"FINISHED"}


def _other_nodes(self, context):
    from ..unisg_blender.blender.authoring.stored_behaviour import lesson_of

    item, node = lesson_object(context), active_node(context)
    nodes = list(lesson_of(item).walk())[1:] if item is not None else []
    related = {each.uid for each in node.walk()} if node is not None else set()
    UNISG_OT_lesson_require.choices = [
        (each.uid, each.name or each.kind, each.kind) for each in nodes if each.uid not in related
    ]
    return UNISG_OT_lesson_require.choices  # Blender needs the strings kept alive


class UNISG_OT_lesson_require(LessonOperator, bpy.types.Operator):
    """Something that has to be done before the active node"""

    bl_idname = "unisg.lesson_require"
    bl_label = "Add Prerequisite"
    bl_property = "node"
    choices = ()

    node: bpy.props.EnumProperty(name="Before", items=_other_nodes)

    def invoke(self, context, event):
        context.window_manager.invoke_search_popup(self)
        return {"RUNNING_MODAL"}

    def edit(self, context, root, node):
        from ..unisg_blender.behaviour.lesson.edit import change

        wanted = (*dict.fromkeys((*node.requires, self.node)),)
        return change(root, node.uid, lambda each: replace(each, requires=wanted))


class UNISG_OT_lesson_unrequire(LessonOperator, bpy.types.Operator):
    """No longer wait for this"""

    bl_idname = "unisg.lesson_unrequire"
    bl_label = "Remove Prerequisite"

    uid: bpy.props.StringProperty()

    def edit(self, context, root, node):
        from ..unisg_blender.behaviour.lesson.edit import change

        left = tuple(uid for uid in node.requires if uid != self.uid)
        return change(root, node.uid, lambda each: replace(each, requires=left))


class UNISG_OT_lesson_check(bpy.types.Operator):
    """Look for everything that would keep the lesson from being played"""

    bl_idname = "unisg.lesson_check"
    bl_label = "Check Lesson"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if lesson_object(context) is None:
            cls.poll_message_set("The scene has no lesson: add one")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.behaviour import check_scene
        from ..unisg_blender.blender import read_scene

        problems = check_scene(read_scene(context.scene, geometry="none", details=False))
        for problem in problems:
            self.report({"ERROR" if problem.severe else "WARNING"}, problem.message)
        if not problems:
            self.report({"INFO"}, "The lesson is sound")
        return {"FINISHED"}


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
