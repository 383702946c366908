"""Types and fields of actions as panels show them: the fields read and write the object's own JSON.

Nothing is stored beside it. The properties belong to objects, so every edit is one
undo step, and Blender itself greys them for linked objects.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import bpy

from ..unisg_blender.errors import UniSGError
from .base import FileOperator

if TYPE_CHECKING:
    from ..unisg_blender.scene.action_data import ActionData

ANSWERS = 8
TYPES = ("Insert", "Remove", "Use", "Tool", "Question", "Parallel")
TYPE_ITEMS = (
    ("Insert", "Insert", "A target comes to its reference pose"),
    ("Remove", "Remove", "A target leaves its reference pose, or where the scene has it"),
    ("Use", "Use", "A tool touches a target"),
    ("Tool", "Tool", "A tool works at its pose, with its trigger"),
    ("Question", "Question", "The right answers are given"),
    ("Parallel", "Parallel", "All, or any, of a group of actions"),
)


_items: list[tuple[str, str, str]] = []


def type_items(self: object, context: bpy.types.Context | None) -> list[tuple[str, str, str]]:
    """The types that an action can have, those of the user's own too."""
    from ..unisg_blender.behaviour.fulfilment.custom_types import OWN_CONDITIONS

    _items[:] = [*TYPE_ITEMS, *((name, name, "A type of your own") for name in OWN_CONDITIONS)]
    return _items  # Blender needs the strings kept alive


def active_place(context: bpy.types.Context, item: bpy.types.Object) -> int:
    """Which of an object's actions is the active one; -1 without actions."""
    return min(context.window_manager.unisg_action, len(readable_actions(item)) - 1)


def readable_actions(item: bpy.types.Object) -> tuple[ActionData, ...]:
    """The object's actions; none where its property cannot be read (the panel says so)."""
    from ..unisg_blender.blender.authoring.stored_behaviour import actions_of

    try:
        return actions_of(item)
    except UniSGError:
        return ()


def active_action(context: bpy.types.Context, item: bpy.types.Object) -> ActionData | None:
    """The active action of an object, None without."""
    place = active_place(context, item)
    return readable_actions(item)[place] if place >= 0 else None


def _reader(read: Callable[[ActionData], Any], default: Any) -> Callable[[bpy.types.Object], Any]:
    def get(item: bpy.types.Object) -> Any:
        action = active_action(bpy.context, item)
        return default if action is None else read(action)

    return get


def _writer(write: Callable[[ActionData, Any], ActionData]) -> Callable[[bpy.types.Object, Any], None]:
    def set_value(item: bpy.types.Object, value: Any) -> None:
        from ..unisg_blender.blender.authoring.authoring import change_action

        place = active_place(bpy.context, item)
        if place >= 0:
            try:
                change_action(item, place, lambda action: write(action, value))
            except UniSGError as error:  # a property cannot report; the panel says why it is grey
                print(f"UniSG: {error}")

    return set_value


def _field(name: str) -> dict[str, Any]:
    return {
        "get": _reader(lambda action: getattr(action, name), ""),
        "set": _writer(lambda action, value: replace(action, **{name: value})),
    }


def _with_limit(action: ActionData, name: str, value: Any) -> ActionData:
    return replace(action, thresholds=replace(action.thresholds, **{name: value}))


def _limit(name: str, default: float) -> dict[str, Any]:
    return {
        "get": _reader(lambda action: getattr(action.thresholds, name) or 0, default),
        "set": _writer(lambda action, value: _with_limit(action, name, value)),
        "options": set(),
    }


def _length(name: str) -> dict[str, Any]:
    """A limit in metres, shown in the scene's unit as all lengths in Blender are."""
    return {
        "get": _reader(lambda action: (getattr(action.thresholds, name) or 0) / _metres(), 0),
        "set": _writer(lambda action, value: _with_limit(action, name, value * _metres())),
        "options": set(),
    }


def _metres() -> float:
    from ..unisg_blender.blender.scene_units import metres_per_unit

    return metres_per_unit(bpy.context.scene)


def _asked(name: str, default: float) -> Any:
    read = _reader(lambda action: getattr(action.thresholds, name) is not None, False)
    write = _writer(lambda action, asked: _with_limit(action, name, default if asked else None))
    return bpy.props.BoolProperty(name="Asked For", description=f"Ask for this {name}", get=read, set=write)


def _answer(place: int) -> Any:
    def write(action: ActionData, text: str) -> ActionData:
        return replace(action, answers=(*action.answers[:place], text, *action.answers[place + 1 :]))

    read = _reader(lambda action: action.answers[place] if place < len(action.answers) else "", "")
    return bpy.props.StringProperty(name=f"Answer {place + 1}", get=read, set=_writer(write))


def _correct(place: int) -> Any:
    def write(action: ActionData, right: bool) -> ActionData:
        return replace(
            action, correct=tuple(sorted({*action.correct, place} if right else {*action.correct} - {place}))
        )

    read = _reader(lambda action: place in action.correct, False)
    return bpy.props.BoolProperty(name="Right", description="This answer is right", get=read, set=_writer(write))


def _pick(slot: str) -> Callable[[bpy.types.WindowManager, bpy.types.Context], None]:
    def update(manager: bpy.types.WindowManager, context: bpy.types.Context) -> None:
        picked = getattr(manager, f"unisg_pick_{slot}")
        if picked is not None:
            setattr(manager, f"unisg_pick_{slot}", None)
            bpy.ops.unisg.action_link(slot=slot, name=picked.name)
            bpy.ops.ed.undo_push(message=f"Choose {slot}")  # a call from a property makes no undo step of its own

    return update


def _properties() -> dict[str, Any]:
    props = bpy.props
    found = {
        "name": props.StringProperty(name="Name", description="What a learner reads", **_field("name")),
        "type": props.EnumProperty(
            name="Type",
            description="What has to happen",
            items=TYPE_ITEMS,
            get=_reader(lambda action: TYPES.index(action.type) if action.type in TYPES else 0, 0),
            set=_writer(lambda action, value: replace(action, type=TYPES[value])),
        ),
        "trigger": props.BoolProperty(
            name="Trigger", description="The tool's trigger has to be pressed",
            get=_reader(lambda action: action.trigger, False),
            set=_writer(lambda action, value: replace(action, trigger=value)),
        ),
        "any": props.BoolProperty(
            name="Any Is Enough", description="One action of the group is enough, not all",
            get=_reader(lambda action: action.mode == "any", False),
            set=_writer(lambda action, value: replace(action, mode="any" if value else "all")),
        ),
        "distance": props.FloatProperty(name="Distance", min=0, unit="LENGTH", precision=3, **_length("distance")),
        "angle": props.FloatProperty(name="Angle", min=0, max=3.141593, unit="ROTATION", **_limit("angle", 0)),
        "hold": props.FloatProperty(name="Hold", min=0, description="Seconds that it has to last", **_limit("hold", 0)),
        "hits": props.IntProperty(name="Hits", min=1, description="How many times", **_limit("hits", 1)),
        "force": props.FloatProperty(name="Force (N)", min=0, description="Newtons, at least", **_limit("force", 0)),
    }  # fmt: skip
    starts = {"distance": 0.02, "angle": 0.26, "hold": 1.0, "hits": 2, "force": 5.0}
    found |= {f"ask_{name}": _asked(name, default) for name, default in starts.items()}
    found |= {f"answer_{place}": _answer(place) for place in range(ANSWERS)}
    found |= {f"correct_{place}": _correct(place) for place in range(ANSWERS)}
    return found


class UNISG_OT_load_types(FileOperator):
    """Run a Python file that defines action types of your own; they are known until Blender ends"""

    bl_idname = "unisg.load_types"
    bl_label = "Load Action Types"
    bl_options = {"REGISTER"}

    filter_glob: bpy.props.StringProperty(default="*.py", options={"HIDDEN"})

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.behaviour.fulfilment.custom_types import load_types

        self.report({"INFO"}, f"Action types: {', '.join(load_types(bpy.path.abspath(self.filepath)))}")


CLASSES = (UNISG_OT_load_types,)
PROPERTIES = (
    *((bpy.types.Object, f"unisg_action_{name}", prop) for name, prop in _properties().items()),
    (bpy.types.WindowManager, "unisg_action", bpy.props.IntProperty(min=0, options={"SKIP_SAVE"})),
    *(
        (
            bpy.types.WindowManager,
            f"unisg_pick_{slot}",
            bpy.props.PointerProperty(type=bpy.types.Object, name=what, update=_pick(slot)),
        )
        for slot, what in (("targets", "Add Target"), ("tools", "Add Tool"), ("frame", "Frame"))
    ),
)
