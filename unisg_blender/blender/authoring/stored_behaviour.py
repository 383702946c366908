"""Behaviour at Blender's edge: actions and lessons of objects, written and watched."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

import bpy
import numpy as np
from numpy.typing import NDArray

from ...behaviour import Moment, all_actions, moment
from ...errors import UniSGError
from ...scene.action_data import ActionData, actions_from_json, actions_to_json
from ...scene.graph import SceneGraph
from ...scene.hierarchy import world_matrices
from ...scene.lesson_node import LessonNode, lesson_from_json, lesson_to_json
from ...scene.properties import ACTIONS, LSA
from ..lookup import objects_by_uid
from ..scene_frames import frame_rate
from ..scene_units import metres_per_unit, scale_translations

TRIGGER = "unisg_trigger"
FORCE = "unisg_force"
"""Numbers on a tool that may be animated: its trigger is pressed (not 0), and the force in newtons."""


@lru_cache(maxsize=1024)
def _decoded_actions(text: str) -> tuple[ActionData, ...]:
    return actions_from_json(text)


@lru_cache(maxsize=64)
def _decoded_lesson(text: str) -> LessonNode:
    return lesson_from_json(text)


def actions_of(item: bpy.types.Object) -> tuple[ActionData, ...]:
    """The actions that belong to an object, as they are stored.

    Raises
    ------
    UniSGError
        If its custom property cannot be read.
    """
    value = item.get(ACTIONS)
    return _decoded_actions(value) if isinstance(value, str) and value else ()


def store_actions(item: bpy.types.Object, actions: Sequence[ActionData]) -> None:
    """Write an object's actions; without any, the custom property goes."""
    _store(item, ACTIONS, actions_to_json(actions) if actions else None)


def lesson_of(item: bpy.types.Object) -> LessonNode | None:
    """The operation that an object stands for, None if it does not.

    Raises
    ------
    UniSGError
        If its custom property cannot be read.
    """
    value = item.get(LSA)
    return _decoded_lesson(value) if isinstance(value, str) and value else None


def store_lesson(item: bpy.types.Object, operation: LessonNode | None) -> None:
    """Write the operation that an object stands for; None takes it away."""
    _store(item, LSA, None if operation is None else lesson_to_json(operation))


def _store(item: bpy.types.Object, key: str, text: str | None) -> None:
    reason = why_fixed(item, key)
    if reason:
        raise UniSGError(reason)
    item.update_tag(refresh={"OBJECT"})  # custom properties alone do not tell Blender that something has changed
    if text is None:
        item.pop(key, None)
        return
    item[key] = text
    if item.override_library is None:
        item.property_overridable_library_set(f'["{key}"]', True)  # so that overrides of it in other files may differ


def why_fixed(item: bpy.types.Object, key: str = ACTIONS) -> str:
    """Why an object's behaviour (the custom property ``key``) cannot be changed here, "" if it can."""
    if item.library is not None:
        return f"{item.name!r} is linked from another file: make a library override, or edit it there"
    override = item.override_library
    if override is None or key not in override.reference:
        return ""
    if override.is_system_override:
        return f"{item.name!r} is a library override that is not editable: make it editable first"
    if not item.is_property_overridable_library(f'["{key}"]'):
        path = override.reference.library.filepath
        return f"{item.name!r} may not be overridden: open {path} and edit its behaviour there once with UniSG"
    return ""


def world_of(
    graph: SceneGraph, scene: bpy.types.Scene, objects: dict[str, bpy.types.Object], last: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Evaluated world matrices (N, 4, 4) of the graph's entities, in metres; of what is gone, the ``last`` ones."""
    world = last.copy()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    there = [row for row, uid in enumerate(graph.uid) if uid in objects]
    for row in there:
        world[row] = objects[graph.uid[row]].evaluated_get(depsgraph).matrix_world
    world[there] = scale_translations(world[there], metres_per_unit(scene))
    return world


def has_animation(scene: bpy.types.Scene) -> bool:
    """Whether anything in the scene may move when its frames are played."""
    if scene.rigidbody_world is not None and scene.rigidbody_world.enabled:
        return True
    for item in scene.objects:
        owners = (item, item.data, getattr(item.data, "shape_keys", None))
        if any(owner is not None and getattr(owner, "animation_data", None) is not None for owner in owners):
            return True
    return False


def scene_moments(scene: bpy.types.Scene, graph: SceneGraph) -> Iterator[Moment]:
    """The frames of a scene's animation as moments.

    Triggers and forces are the animated numbers ``unisg_trigger`` and ``unisg_force``
    of the tools; a timeline marker such as "How many swabs? = three" answers the
    Question of that name (several answers with commas). The current frame is kept.
    """
    rate = frame_rate(scene)
    before, world = scene.frame_current, world_matrices(graph)
    objects = objects_by_uid(scene)
    try:
        for frame in range(scene.frame_start, scene.frame_end + 1):
            scene.frame_set(frame)
            world = world_of(graph, scene, objects, world)
            pressed = [uid for uid, item in objects.items() if _number(item, TRIGGER)]
            force = {uid: _number(item, FORCE) for uid, item in objects.items() if FORCE in item}
            answers = _answers(scene, graph, frame)
            yield moment(graph, (frame - scene.frame_start) / rate, world, pressed, force, answers)
    finally:
        scene.frame_set(before)


def _number(item: bpy.types.Object, key: str) -> float:
    value = item.get(key, 0.0)
    return float(value) if isinstance(value, int | float) else 0.0


def _answers(scene: bpy.types.Scene, graph: SceneGraph, frame: int) -> dict[str, tuple[int, ...]]:
    found: dict[str, tuple[int, ...]] = {}
    for marker in scene.timeline_markers:
        question, equals, text = marker.name.rpartition("=")
        if marker.frame != frame or not equals:
            continue
        for action in all_actions(graph):
            if action.type == "Question" and question.strip() in (action.name, action.uid):
                chosen = [each.strip() for each in text.split(",")]
                found[action.uid] = tuple(place for place, answer in enumerate(action.answers) if answer in chosen)
    return found
