"""Correct what is recognised of the building: what selected objects are, and what a room is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...unisg_blender.errors import UniSGError
from ..base import Operator
from .recognised import Recognised, recognise_now, recognise_soon, recognised

if TYPE_CHECKING:
    from ...unisg_blender.spatial.structure.room_things import RoomName

PARTS = (
    ("FLOOR", "Floor", "People walk on it. Where something is called a floor, nothing else is one: select all floors"),
    ("WALL", "Wall", "It bounds rooms"),
    ("CEILING", "Ceiling", "It covers rooms"),
    ("DOOR", "Door", "It is a door; the way through it stays free"),
    ("WINDOW", "Window", "It is a window"),
    ("THING", "Not Building", "It is a thing in a room and no part of the building, whatever it looks like"),
    ("NOTHING", "Not There", "It counts as nothing: a sky, a backdrop, a collision hull"),
    ("", "As Recognised", "Take back what was said: it is what it looks like"),
)  # fmt: skip


class UNISG_OT_mark_part(Operator):
    """Say what the selected objects are in the building; it counts before what is recognised and is kept in the file"""

    bl_idname = "unisg.mark_part"
    bl_label = "This Is"
    bl_options = {"REGISTER", "UNDO"}

    part: bpy.props.EnumProperty(name="Part", items=[(key or "CLEAR", *rest) for key, *rest in PARTS], default="THING")

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        return next(text for key, _, text in PARTS if (key or "CLEAR") == properties.part)

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        if context.mode != "OBJECT":
            return "Leave edit mode first"
        return "" if any(item.library is None for item in context.selected_objects) else "Select objects of this file"

    def run(self, context: bpy.types.Context) -> None:
        from ...unisg_blender.blender.authoring.building_marks import mark_parts

        part = "" if self.part == "CLEAR" else self.part
        count = mark_parts(context.selected_objects, part)
        name = next(label for key, label, _ in PARTS if key == part)
        self.report({"INFO"}, f"{count} object{'s' * (count != 1)}: {name}")
        recognise_soon(context.scene)


def _kinds(operator: object, context: bpy.types.Context, text: str) -> Iterator[str]:
    from ...unisg_blender.scene.structure_marks import NO_ROOM
    from ...unisg_blender.words.room_kinds import room_table

    return (kind for kind in (*room_table().things, NO_ROOM) if text.casefold() in kind)


class UNISG_OT_mark_room(Operator):
    """Say what a room is, or that it is none; an Empty in the room keeps it in the file"""

    bl_idname = "unisg.mark_room"
    bl_label = "This Room Is"
    bl_options = {"REGISTER", "UNDO"}
    bl_property = "kind"

    kind: bpy.props.StringProperty(
        name="Room", description='What it is, such as "kitchen"; "none": it is no room; empty: what its things tell',
        search=_kinds, search_options={"SUGGESTION"}, options={"SKIP_SAVE"},
    )  # fmt: skip
    number: bpy.props.IntProperty(
        name="Number", description="Of the room; -1 for the one of the active object", default=-1, min=-1,
        options={"SKIP_SAVE"},
    )  # fmt: skip

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if context.mode == "OBJECT" else "Leave edit mode first"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return context.window_manager.invoke_props_dialog(self)

    def run(self, context: bpy.types.Context) -> None:
        from ...unisg_blender.blender import objects_by_uid
        from ...unisg_blender.blender.authoring.building_marks import mark_room

        found = recognise_now(context.scene)
        number = self._number(context, found)
        room = found.structure.rooms[number]
        uid = _marker_of(found, number)
        kind, floor_point = self.kind.strip(), np.append(room.inner_point, room.floor)
        mark_room(context.scene, kind, floor_point, found.units, objects_by_uid(context.scene).get(uid))
        self.report({"INFO"}, f"Room {number}: {kind or 'what its things tell'}")
        recognise_soon(context.scene)

    def _number(self, context: bpy.types.Context, found: Recognised) -> int:
        from ...unisg_blender.spatial.objects import middle_of

        count = len(found.structure.rooms)
        number = self.number
        if number < 0 and context.active_object is not None:
            middle = middle_of(found.graph, context.active_object.name)
            number = -1 if middle is None else found.structure.room_at(middle)
            if number < 0:
                raise UniSGError(f"{context.active_object.name} is in no room that is recognised")
        if not 0 <= number < count:
            raise UniSGError(f"there is no room {number}: {count} are recognised" if count else found.summary)
        return number


def _marker_of(found: Recognised, number: int) -> str:
    """The uid of what says which kind a room is, "" where nothing does."""
    from ...unisg_blender.scene.structure_marks import ROOM_MARK, marks
    from ...unisg_blender.spatial.structure.room_marks import marked_by

    by = marked_by(found.structure, found.graph)
    return next((found.graph.uid[row] for row in marks(found.graph, ROOM_MARK) if by.get(row) == number), "")


class UNISG_OT_recognise(Operator):
    """Look anew at what is building in the scene: rooms, floors, walls, doors, windows, surfaces that hold things"""

    bl_idname = "unisg.recognise"
    bl_label = "Recognise Building"
    bl_options = {"REGISTER"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if len(context.scene.objects) else "The scene has no objects"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        recognise_soon(context.scene)
        return {"FINISHED"}

    def run(self, context: bpy.types.Context) -> None:
        self.report({"INFO"}, recognise_now(context.scene).summary)


def rooms_to_choose(settings: object, context: bpy.types.Context, text: str) -> list[tuple[str, str]]:
    """Rooms of the current scene for a search field: what each is, or its number where that is not enough."""
    found = recognised(context.scene)
    if found is None:
        recognise_soon(context.scene)
        return []
    pairs = zip(_told_apart(found.names), found.room_lines(), strict=True)
    return [(said, line) for names, line in pairs for said in names if text.casefold() in f"{said} {line}".casefold()]


def _told_apart(names: Sequence[RoomName]) -> list[list[str]]:
    """For each room the words by which only it is found, or else its number: "living room and kitchen" is a kitchen.

    It is what :func:`~.named_rooms.find_room` understands: what a room is first counts before what it is also.
    """
    first = [name.kind for name in names]
    also = [kind for name in names for kind in name.also]
    found = []
    for number, name in enumerate(names):
        alone = [kind for kind in name.also if kind not in first and also.count(kind) == 1]
        alone = [name.kind, *alone] if name.kind and first.count(name.kind) == 1 else alone
        found.append(alone or [str(number)])
    return found


CLASSES = (UNISG_OT_mark_part, UNISG_OT_mark_room, UNISG_OT_recognise)
