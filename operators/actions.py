"""Give objects actions and say what these need."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import bpy

from ..unisg_blender.errors import UniSGError
from .action_properties import ANSWERS, active_action, active_place, readable_actions, type_items
from .base import Operator, SearchOperator, redraw_views

if TYPE_CHECKING:
    from ..unisg_blender.scene.action_data import ActionData

SLOT_ITEMS = (
    ("targets", "Targets", "What the action is about"),
    ("tools", "Tools", "What is used in it"),
    ("frame", "Frame", "The object that the reference pose belongs to"),
)


class ActionOperator(Operator):
    """An operator on the active object's actions."""

    bl_options = {"REGISTER", "UNDO"}
    needs_action = True

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        from ..unisg_blender.blender.authoring.stored_behaviour import why_fixed

        item = context.active_object
        if item is None:
            return "Select the object that the actions belong to"
        lacks = cls.needs_action and not readable_actions(item)
        return why_fixed(item) or (f"{item.name!r} has no actions: add one" if lacks else "")

    def act(self, context: bpy.types.Context, item: bpy.types.Object, place: int) -> None:
        """Change the active object's actions; ``place`` is that of the active one."""
        raise NotImplementedError

    def run(self, context: bpy.types.Context) -> None:
        self.act(context, context.active_object, active_place(context, context.active_object))
        redraw_views(context)


class ListOperator(ActionOperator):
    """Changes the list of actions, and which of them is the active one."""

    def changed(self, actions: list[ActionData], place: int) -> int:
        """Change the list in place; returns the place of the action that is active then."""
        raise NotImplementedError

    def act(self, context: bpy.types.Context, item: bpy.types.Object, place: int) -> None:
        from ..unisg_blender.blender.authoring.stored_behaviour import actions_of, store_actions

        actions = list(actions_of(item))
        active = self.changed(actions, place)
        store_actions(item, actions)
        context.window_manager.unisg_action = active


class EditOperator(ActionOperator):
    """Changes the active action."""

    def edited(self, action: ActionData) -> ActionData:
        """The action as it shall be."""
        raise NotImplementedError

    def act(self, context: bpy.types.Context, item: bpy.types.Object, place: int) -> None:
        from ..unisg_blender.blender.authoring.authoring import change_action

        change_action(item, place, self.edited)


class UNISG_OT_action_add(ActionOperator):
    """Add an action to the active object"""

    bl_idname = "unisg.action_add"
    bl_label = "Add Action"
    needs_action = False

    type: bpy.props.EnumProperty(name="Type", items=type_items)

    def act(self, context: bpy.types.Context, item: bpy.types.Object, place: int) -> None:
        from ..unisg_blender.blender.authoring.authoring import add_action, link_objects

        place = add_action(context.scene, item, self.type)
        context.window_manager.unisg_action = place
        others = [other for other in context.selected_objects if other != item]
        if others and self.type in ("Use", "Tool"):
            link_objects(context.scene, item, place, "tools", others)


class UNISG_OT_action_remove(ListOperator):
    """Remove the active action"""

    bl_idname = "unisg.action_remove"
    bl_label = "Remove Action"

    def changed(self, actions: list[ActionData], place: int) -> int:
        del actions[place]
        return max(0, place - 1)


class UNISG_OT_action_duplicate(ListOperator):
    """Copy the active action"""

    bl_idname = "unisg.action_duplicate"
    bl_label = "Duplicate Action"

    def changed(self, actions: list[ActionData], place: int) -> int:
        from ..unisg_blender.scene.identity import new_uid

        actions.insert(place + 1, replace(actions[place], uid=new_uid()))
        return place + 1


class UNISG_OT_action_select(Operator):
    """Make this the active action"""

    bl_idname = "unisg.action_select"
    bl_label = "Select Action"
    bl_options = {"INTERNAL"}

    place: bpy.props.IntProperty(options={"HIDDEN"})

    def run(self, context: bpy.types.Context) -> None:
        context.window_manager.unisg_action = self.place
        redraw_views(context)


class UNISG_OT_action_move(ListOperator):
    """Move the active action in the object's list"""

    bl_idname = "unisg.action_move"
    bl_label = "Move Action"

    step: bpy.props.IntProperty(default=1, min=-1, max=1)

    def changed(self, actions: list[ActionData], place: int) -> int:
        to = min(max(place + self.step, 0), len(actions) - 1)
        actions.insert(to, actions.pop(place))
        return to


class UNISG_OT_action_link(ActionOperator):
    """Let the active action use the other selected objects, or the object of that name"""

    bl_idname = "unisg.action_link"
    bl_label = "Use Selected"

    slot: bpy.props.EnumProperty(name="As", items=SLOT_ITEMS)
    name: bpy.props.StringProperty(
        name="Object", description="An object; the other selected ones if empty", options={"SKIP_SAVE"}
    )

    def act(self, context: bpy.types.Context, item: bpy.types.Object, place: int) -> None:
        from ..unisg_blender.blender.authoring.authoring import link_objects, set_frame

        others = [other for other in context.selected_objects if other != item]
        if self.name:
            others = [context.scene.objects[self.name]] if self.name in context.scene.objects else []
        if not others:
            raise UniSGError(f"{self.name!r} is not in the scene" if self.name else "select other objects as well")
        if self.slot == "frame":
            set_frame(context.scene, item, place, others[0])
        else:
            link_objects(context.scene, item, place, self.slot, others)


class UNISG_OT_action_unlink(ActionOperator):
    """Take this out of the action"""

    bl_idname = "unisg.action_unlink"
    bl_label = "Take Out"

    slot: bpy.props.StringProperty()
    uid: bpy.props.StringProperty(options={"HIDDEN"})

    def act(self, context: bpy.types.Context, item: bpy.types.Object, place: int) -> None:
        from ..unisg_blender.blender.authoring.authoring import set_frame, unlink_object

        if self.slot == "frame":
            set_frame(context.scene, item, place, None)
        else:
            unlink_object(item, place, self.slot, self.uid)


_choices: list[tuple[str, str, str]] = []


def _other_actions(self: object, context: bpy.types.Context) -> list[tuple[str, str, str]]:
    from ..unisg_blender.blender.authoring.authoring import scene_actions

    active = active_action(context, context.active_object)
    _choices[:] = [
        (action.uid, action.name or action.type, f"{action.type} of {owner.name}")
        for owner, action in scene_actions(context.scene)
        if active is None or action.uid not in (active.uid, *active.members)
    ]
    return _choices  # Blender needs the strings kept alive


class UNISG_OT_action_member(SearchOperator, EditOperator):
    """Add an action of the scene to the group"""

    bl_idname = "unisg.action_member"
    bl_label = "Add Member"
    bl_property = "member"

    member: bpy.props.EnumProperty(name="Action", items=_other_actions)

    def edited(self, action: ActionData) -> ActionData:
        name = {uid: name for uid, name, _ in _choices}.get(self.member, "")
        return replace(action, members=(*action.members, self.member), names={**action.names, self.member: name})


class UNISG_OT_action_reference(ActionOperator):
    """Make the present pose of the target the reference pose (of the tool in a Tool action)"""

    bl_idname = "unisg.action_reference"
    bl_label = "Reference From Current Pose"

    def act(self, context: bpy.types.Context, item: bpy.types.Object, place: int) -> None:
        from ..unisg_blender.blender.authoring.authoring import reference_from_pose

        reference_from_pose(context.scene, item, place)


class UNISG_OT_action_go_to_reference(ActionOperator):
    """Put the target at its reference pose, to see what the action asks for"""

    bl_idname = "unisg.action_go_to_reference"
    bl_label = "Go To Reference"

    def act(self, context: bpy.types.Context, item: bpy.types.Object, place: int) -> None:
        import mathutils

        from ..unisg_blender.blender.authoring.authoring import frame_matrix, posed_object

        action = readable_actions(item)[place]
        if action.reference_matrix is None:
            raise UniSGError("the action has no reference pose yet")
        target = posed_object(context.scene, action)
        target.matrix_world = mathutils.Matrix(frame_matrix(context.scene, action) @ action.reference_matrix)


class UNISG_OT_action_answers(EditOperator):
    """Add an answer, or remove the last one"""

    bl_idname = "unisg.action_answers"
    bl_label = "Answers"

    add: bpy.props.BoolProperty(default=True)

    def edited(self, action: ActionData) -> ActionData:
        answers = (*action.answers, f"Answer {len(action.answers) + 1}") if self.add else action.answers[:-1]
        answers = answers[:ANSWERS]
        return replace(action, answers=answers, correct=tuple(at for at in action.correct if at < len(answers)))


CLASSES = (
    UNISG_OT_action_add,
    UNISG_OT_action_remove,
    UNISG_OT_action_duplicate,
    UNISG_OT_action_select,
    UNISG_OT_action_move,
    UNISG_OT_action_link,
    UNISG_OT_action_unlink,
    UNISG_OT_action_member,
    UNISG_OT_action_reference,
    UNISG_OT_action_go_to_reference,
    UNISG_OT_action_answers,
)
