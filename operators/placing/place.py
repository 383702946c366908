"""Place a thing by pointing: the model says where it belongs, a ghost stands there, a click puts it down."""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING

import bpy
import numpy as np
from bpy.app.handlers import persistent

from ...unisg_blender.errors import UniSGError
from ..base import Operator, redraw_views
from ..making.generation_settings import chosen_model, load_generator, read_words, scene_in_words
from ..making.new_objects import bring_in, select_new
from ..making.sampling_choices import VarietyChoice
from ..window_wording import in_window
from .asset_of_thing import asset_and_shapes
from .choose_and_place import ask_what
from .placing_session import Placing, PlacingChoice, begin_placing, end_placing, look_at_room, placing
from .pointed_at import pointed_at, viewport_under

if TYPE_CHECKING:
    from ...unisg_blender.generate.pointing.ghosts import Ghost
    from ...unisg_blender.generate.pointing.placing_room import PlacingRoom

TURN = math.radians(15)
KEYS = (
    "Click: place    Shift Click: place and go on    Wheel: next likely place    Shift Wheel: turn    "
    "D: another shape    R: anywhere else    L: lock    Esc: leave"
)
PASSED = frozenset((
    "MIDDLEMOUSE", "TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE", "MOUSESMARTZOOM", "HOME", "N", "T", "ACCENT_GRAVE",
    "INBETWEEN_MOUSEMOVE", "WINDOW_DEACTIVATE", "TIMER", "TIMER_REPORT", "TIMER_REGION",
))  # fmt: skip
"""Events by which one looks around meanwhile: those are Blender's; and so are NUMPAD and NDOF."""

HOWS = (
    ("NEAR", "Near", "At the best place near the location, turned as the model would"),
    ("EXACT", "Exactly There", "With its foot at the location, turned as it is said"),
    ("ANYWHERE", "Anywhere", "At a place of the room, drawn by how likely it is"),
)


class UNISG_OT_place(VarietyChoice, Operator):
    """Place a thing by pointing: the room glows where the model would put it; a click places it there"""

    bl_idname = "unisg.place"
    bl_label = "Place..."
    bl_options = {"REGISTER", "UNDO"}

    category: bpy.props.StringProperty(
        name="Category", description="What is placed, in any words; asked for when empty", options={"SKIP_SAVE"}
    )
    source: bpy.props.StringProperty(
        name="Object", options={"SKIP_SAVE"},
        description="An object of the scene, of which another one is placed, its mesh shared if it has no modifiers",
    )  # fmt: skip
    collection: bpy.props.StringProperty(
        name="Collection", description="Of this file; an instance of it is placed", options={"SKIP_SAVE"}
    )
    asset: bpy.props.StringProperty(
        name="Asset", description="What is placed of an asset library", options={"HIDDEN", "SKIP_SAVE"}
    )
    how: bpy.props.EnumProperty(name="Where", items=HOWS, options={"SKIP_SAVE"})
    location: bpy.props.FloatVectorProperty(
        name="Location", subtype="TRANSLATION", size=3, options={"SKIP_SAVE"},
        description="Where it is placed, or near where; the 3D cursor's when it is not given",
    )  # fmt: skip
    turn: bpy.props.FloatProperty(name="Turn", description="About the vertical", subtype="ANGLE", options={"SKIP_SAVE"})
    shape: bpy.props.IntProperty(
        name="Shape", description="Which of the shapes that there are", min=0, options={"SKIP_SAVE"}
    )
    on: bpy.props.StringProperty(name="On", description="The object on which it is wanted", options={"SKIP_SAVE"})
    beside: bpy.props.StringProperty(
        name="Beside", description="The object beside which it is wanted", options={"SKIP_SAVE"}
    )
    behaviour: bpy.props.BoolProperty(
        name="With actions", description="Give it the actions that the lesson lacks", default=True,
        options={"SKIP_SAVE"},
    )  # fmt: skip
    lock: bpy.props.BoolProperty(name="Lock", description="Neither Settle nor Re-roll moves it", options={"SKIP_SAVE"})
    seed: bpy.props.IntProperty(
        name="Seed", description="The same seed gives the same place; -1 gives another one each time", default=-1,
        min=-1, options={"SKIP_SAVE"},
    )  # fmt: skip
    model: bpy.props.StringProperty(
        name="Model", description="ONNX file or name of a shipped model; the panel's when empty",
        options={"HIDDEN", "SKIP_SAVE"},
    )  # fmt: skip
    words: bpy.props.StringProperty(name="Words", description="A mapping file", options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if context.mode == "OBJECT" else "Leave edit mode first"

    def run(self, context: bpy.types.Context) -> None:
        """Place it where it is said, with nobody pointing: for scripts, and when something is changed afterwards."""
        from ...unisg_blender.blender.scene_units import metres_per_unit

        metres = metres_per_unit(context.scene)
        if not self.properties.is_property_set("location"):
            self.location = context.scene.cursor.location
        if self.seed < 0:
            self.seed = random.randrange(2**31)
        choice = self._choice(context)
        load_generator(choice.model)
        graph = scene_in_words(context.scene, choice.words or {})
        point = tuple(metres * value for value in self.location)
        room = look_at_room(graph, choice, None if self.how == "ANYWHERE" else point)
        self._put(context, room, self._said(room, np.array(point)))

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        settings = context.window_manager.unisg
        self.behaviour = self.behaviour and settings.behaviour
        if not self.properties.is_property_set("variety"):
            self.variety = settings.variety
        if not (self.category or self.source or self.collection or self.asset):
            return self.reporting(ask_what, context)
        return self.reporting(self._begin, context, event)

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        current = placing()
        if current is not self._own:
            return {"CANCELLED"}  # it was begun anew, by another button
        if current is None or current.scene != context.scene.name or context.mode != "OBJECT":
            return self._leave(context)
        under = viewport_under(context, event)
        if event.type in ("ESC", "RIGHTMOUSE") and event.value == "PRESS" and (under or event.type == "ESC"):
            return self._leave(context)
        if under is None or self._is_blenders(event):
            return {"PASS_THROUGH"}
        if event.type == "MOUSEMOVE":
            self._move(context, under, (event.mouse_x - under[0].x, event.mouse_y - under[0].y))
        elif event.type == "LEFTMOUSE" and event.value == "PRESS":
            return self.reporting(self._click, context, event.shift)
        elif event.value == "PRESS":
            self._press(event)
        redraw_views(context)
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends it: another file is opened, a window closed, the extension switched off."""
        end_placing()

    def draw(self, context: bpy.types.Context) -> None:
        """What can be changed afterwards."""
        layout = self.layout
        layout.use_property_split = True
        layout.label(text=self.category or self.source or self.collection)
        layout.prop(self, "how")
        if self.how != "ANYWHERE":
            layout.prop(self, "location")
            layout.prop(self, "turn")
        else:
            layout.prop(self, "variety")
        for name in ("shape", "behaviour", "lock"):
            layout.prop(self, name)

    def _choice(self, context: bpy.types.Context) -> PlacingChoice:
        """What is chosen here, and in the panel as far as nothing is."""
        words = read_words(self.words or context.window_manager.unisg.words)
        path = bpy.path.abspath(self.model or chosen_model(context))
        asset, shapes = asset_and_shapes(context.scene, self)
        return PlacingChoice(
            path, self.category, self.source, asset, shapes, self.shape, words, self.on, self.beside,
            max(self.seed, 0), self.variety,
        )  # fmt: skip

    def _begin(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        begin_placing(Placing(context.scene, self._choice(context), self.behaviour))
        current = placing()
        assert current is not None
        self._own, current.locked = current, self.lock
        under = viewport_under(context, event)
        if under is not None:
            self._move(context, under, (event.mouse_x - under[0].x, event.mouse_y - under[0].y))
        current.look(anew=True)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set(KEYS)
        redraw_views(context)
        return {"RUNNING_MODAL"}

    def _leave(self, context: bpy.types.Context) -> set[str]:
        end_placing()
        redraw_views(context)
        return {"CANCELLED"}

    def _is_blenders(self, event: bpy.types.Event) -> bool:
        """Is it an event by which one looks around, undoes, or zooms?"""
        if event.type in PASSED or event.type.startswith(("NUMPAD", "NDOF")):
            return True
        wheel = event.type in ("WHEELUPMOUSE", "WHEELDOWNMOUSE") and (event.ctrl or event.alt)
        return wheel or (event.type == "Z" and (event.ctrl or event.oskey))

    def _move(
        self, context: bpy.types.Context, under: tuple[bpy.types.Region, bpy.types.RegionView3D], mouse: tuple[int, int]
    ) -> None:
        current = placing()
        if current is not None:
            current.mouse, current.region = mouse, under[0].as_pointer()
            current.point_at(pointed_at(context, *under, mouse, current.room, current.metres))

    def _press(self, event: bpy.types.Event) -> None:
        """A key, or the wheel, while placing."""
        current = placing()
        if current is None:
            return
        step = {"WHEELUPMOUSE": -1, "WHEELDOWNMOUSE": 1}.get(event.type, 0)
        if step and event.shift:
            current.turn_by(-step * TURN)
        elif step:
            current.next_place(step)
        elif event.type == "D":
            current.other_shape()
        elif event.type == "R":
            current.draw_anew()
        elif event.type == "L":
            current.locked = not current.locked

    def _click(self, context: bpy.types.Context, go_on: bool) -> set[str]:
        """Put it down where its ghost is, and end, or go on with the next."""
        current = placing()
        assert current is not None
        if current.room is None or current.ghost is None:
            self.report({"WARNING"}, current.failed or current.text or "Point at a place in the room first")
            return {"RUNNING_MODAL"}
        room, ghost = current.room, current.ghost
        self.lock, self.behaviour, self.shape = current.locked, current.behaviour, current.choice.shape
        self.model = current.choice.model
        self.seed = random.randrange(2**31)
        self._put(context, room, ghost)
        self.how, self.turn = "EXACT", float(ghost.place[3])
        self.location = tuple(ghost.place[:3] / current.metres)
        if not go_on:
            self._leave(context)
            return {"FINISHED"}
        bpy.ops.ed.undo_push(message=f"Place {room.wanted.category}")
        current.look(anew=True)
        return {"RUNNING_MODAL"}

    def _said(self, room: PlacingRoom, point: np.ndarray) -> Ghost:
        """The place that the properties say."""
        from ...unisg_blender.generate import Sampling
        from ...unisg_blender.generate.pointing.ghosts import ghost_anywhere, ghost_at, ghost_by_hand, ghost_near

        if self.how == "EXACT":
            return ghost_at(room, np.append(point, self.turn))
        if self.how == "NEAR" and self.turn:
            return ghost_by_hand(room, point, self.turn)
        rng, drawn = np.random.default_rng(self.seed), Sampling(self.variety)
        found = ghost_anywhere(room, rng, drawn) if self.how == "ANYWHERE" else None
        found = ghost_near(room, point) if self.how == "NEAR" else found
        if found is None:
            where = "near there" if self.how == "NEAR" else "in the room"
            raise UniSGError(
                f"no free place for {room.wanted.category} {where}: {room.note or 'other things are there'}"
            )
        return found

    def _put(self, context: bpy.types.Context, room: PlacingRoom, ghost: Ghost) -> None:
        """Make the object, and say what is wrong with it."""
        from ...unisg_blender.blender.authoring.object_locks import set_locked
        from ...unisg_blender.generate.pointing.ghosts import measured
        from ...unisg_blender.generate.pointing.placed_object import place_ghost

        ghost = measured(room, ghost)
        result = place_ghost(room, ghost, self.seed, self.behaviour)
        objects = bring_in(context, result)
        if self.lock:
            set_locked(objects[:1], True)
        select_new(context, objects, (self.on, self.beside))
        name, holder = result.objects[0].name, result.objects[0].support
        where = f" on {holder}" if holder else ""
        for line in ghost.wrong:
            self.report({"WARNING"}, f"{name} {line}")
        if not ghost.wrong:
            self.report({"INFO"}, in_window(f"{name} placed{where}"))


@persistent
def _undone(*_: object) -> None:
    current = placing()
    if current is not None and current.scene in bpy.data.scenes:
        current.look(anew=True)


@persistent
def _loaded(*_: object) -> None:
    end_placing()


CLASSES = (UNISG_OT_place,)
HANDLERS = (("undo_post", _undone), ("redo_post", _undone), ("load_pre", _loaded))


def unregister() -> None:
    """Nothing goes on without the extension."""
    end_placing()
