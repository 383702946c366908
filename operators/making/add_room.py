"""Add a whole room at the 3D cursor: furnished, with its lesson, a camera and a light, in a collection of its own."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

import bpy
import mathutils
import numpy as np

from ..base import Operator
from ..room.checking import check_again
from .generation_settings import choose_model
from .suggest import suggest_again

if TYPE_CHECKING:
    from numpy.typing import NDArray

ROOMS = (
    ("operating-room", "Operating Room", "An operating room with staff's equipment, and the lesson of an operation"),
    ("living-room", "Living Room", "A furnished living room"),
)  # fmt: skip

EYE, AIM, INWARDS, LENS = 1.9, 0.8, 0.25, 18.0
"""Metres over the floor of the camera and of what it looks at, and how far it is from the corner; millimetres."""

LIGHT, WATTS, ACROSS = 2.3, 120.0, 1.5
"""Metres over the floor of the light; its power, and its size in metres."""


class UNISG_OT_add_room(Operator):
    """Add a whole furnished room at the 3D cursor, its categories, relations and lesson included"""

    bl_idname = "unisg.add_room"
    bl_label = "Add Room"
    bl_options = {"REGISTER", "UNDO"}

    kind: bpy.props.EnumProperty(name="Room", items=ROOMS)
    seed: bpy.props.IntProperty(
        name="Seed", description="The same seed gives the same room; -1 gives another one each time",
        default=-1, min=-1, options={"SKIP_SAVE"},
    )  # fmt: skip
    with_view: bpy.props.BoolProperty(
        name="Camera and Light", description="Add a camera that looks into the room, and a light", default=True
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        return f"{next(text for key, _, text in ROOMS if key == properties.kind)}, at the 3D cursor"

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if context.mode == "OBJECT" else "Leave edit mode first"

    def run(self, context: bpy.types.Context) -> None:
        from ...unisg_blender.blender import write_rows
        from ...unisg_blender.blender.authoring.identities import repair_copies
        from ...unisg_blender.blender.scene_units import metres_per_unit
        from ...unisg_blender.scene.augmentation import moved_scene
        from ...unisg_blender.spatial import room_outline
        from ...unisg_blender.worlds import WORLDS

        scene, label = context.scene, next(name for key, name, _ in ROOMS if key == self.kind)
        if self.seed < 0:
            self.seed = random.randrange(2**31)
        units = 1.0 / metres_per_unit(scene)
        motion = np.eye(4)
        motion[:3, 3] = np.array(scene.cursor.location) / units
        graph = moved_scene(WORLDS[self.kind](self.seed), motion)
        collection = bpy.data.collections.new(label)
        scene.collection.children.link(collection)
        items = write_rows(graph, range(len(graph)), scene, collection=collection)
        repair_copies(scene)  # the same room twice is two rooms
        if self.with_view:
            _add_view(scene, collection, room_outline(graph), float(motion[2, 3]), units)
        for item in context.selected_objects:
            item.select_set(False)
        choose_model(context, self.kind.replace("-", "_"))
        check_again()
        suggest_again()
        self.report({"INFO"}, f"{label}: {len(items)} objects (seed {self.seed})")


def _add_view(
    scene: bpy.types.Scene, collection: bpy.types.Collection, outline: NDArray[np.float64], floor: float, units: float
) -> None:
    """A camera in a corner of a room that looks at its middle, and a light over that."""
    middle = outline.mean(axis=0)
    corner = outline[np.linalg.norm(outline - middle, axis=1).argmax()]
    corner = corner + INWARDS * np.sign(middle - corner)
    camera = bpy.data.objects.new("Room Camera", bpy.data.cameras.new("Room Camera"))
    camera.data.lens = LENS
    camera.location = np.append(corner, floor + EYE) * units
    aim = mathutils.Vector(np.append(middle, floor + AIM) * units)
    camera.rotation_euler = (aim - camera.location).to_track_quat("-Z", "Y").to_euler()
    lamp = bpy.data.objects.new("Room Light", bpy.data.lights.new("Room Light", "AREA"))
    lamp.data.energy, lamp.data.size = WATTS * units**2, ACROSS * units
    lamp.location = np.append(middle, floor + LIGHT) * units
    for item in (camera, lamp):
        collection.objects.link(item)
    scene.camera = scene.camera or camera


CLASSES = (UNISG_OT_add_room,)
