"""Recordings: how objects are moved, from playback or while a user moves them, and back onto the scene."""

from __future__ import annotations

import math
from functools import lru_cache

import bpy

from ...behaviour import Event, Input, begin, play, prepare
from ...behaviour.record.pose_recorder import PoseRecorder, needed_keys
from ...behaviour.record.recorded_events import later, new_inputs, with_events
from ...errors import UniSGError
from ...runtime.read_report import ReadReport
from ...scene.components import ANIMATION, EVENTS, RECORDING
from ...scene.graph import SceneGraph
from ...scene.recording_tables import KEY, Recorded, recorded_from_json, recorded_of, recorded_to_json
from ..authoring.stored_behaviour import scene_moments, why_fixed
from ..depsgraph import updated_depsgraph
from ..lookup import objects_by_uid
from ..read.object_hierarchy import read_hierarchy
from ..read.sampled_animation import sample_animation
from ..read.scene_reader import read_scene
from ..scene_frames import frame_rate
from ..scene_units import in_scene_units, metres_per_unit, scale_translations
from ..write.animation_curves import write_animation
from .event_markers import show_events

__all__ = [
    "SceneRecorder", "clear_recording", "needed_keys", "record_playback", "replay", "scene_recording",
    "store_recording",
]  # fmt: skip


class SceneRecorder(PoseRecorder):
    """Looks at a Blender scene; it holds uids and numbers, no Blender objects."""

    def sample(self, scene: bpy.types.Scene, seconds: float) -> int:
        """Look at the scene now; returns how many objects have moved since the last look."""
        items = list(scene.objects)
        _, depsgraph = updated_depsgraph(scene)
        local = read_hierarchy(scene.objects, items, depsgraph).local
        place = {item: row for row, item in enumerate(items)}
        found = objects_by_uid(scene)
        local = scale_translations(local[[place[item] for item in found.values()]], metres_per_unit(scene))
        return self.look(tuple(found), local, seconds)


def record_playback(scene: bpy.types.Scene | None = None) -> SceneGraph:
    """The scenegraph of a scene with all that moves during its playback as the component ``recording``.

    What a lesson makes of it, if the scene has one that can be played, are its ``events``.
    """
    scene = scene or bpy.context.scene
    graph = _without(read_scene(scene), RECORDING, EVENTS)
    graph = sample_animation(graph, scene, range(scene.frame_start, scene.frame_end + 1))
    found = graph.components.get(ANIMATION)
    graph = graph if found is None else _without(graph, ANIMATION).with_component(RECORDING, found)
    try:
        lesson = prepare(graph)
    except UniSGError:
        return graph
    inputs, events = list[Input](), list[Event]()
    state, before = begin(lesson), None
    for now in scene_moments(scene, graph):
        state, happened = play(lesson, state, now)
        inputs += new_inputs(lesson, before, now)
        events, before = [*events, *happened], now
    start = scene.frame_start / frame_rate(scene)  # times of recordings count from frame 0
    return with_events(graph, later(events, start), later(inputs, start))


def _without(graph: SceneGraph, *names: str) -> SceneGraph:
    return graph.replace(components={name: each for name, each in graph.components.items() if name not in names})


def store_recording(graph: SceneGraph, scene: bpy.types.Scene, report: ReadReport | None = None) -> int:
    """Keep the recording and the events of a scenegraph with the scene's objects, in place of what they had.

    Returns
    -------
    int
        How many objects have something recorded now; what cannot be kept is told to ``report``.
    """
    clear_recording(scene)
    graph = in_scene_units(graph, scene)
    objects, count = objects_by_uid(scene), 0
    for row, uid in enumerate(graph.uid):
        recorded, item = recorded_of(graph, row), objects.get(uid)
        if recorded is None or item is None:
            continue
        reason = why_fixed(item, KEY)
        if reason and report is not None:
            report.add(item.name, f"nothing was recorded: {reason}")
        if not reason:
            item[KEY] = recorded_to_json(recorded)
            count += 1
    return count


def clear_recording(scene: bpy.types.Scene) -> None:
    """Forget what was recorded of the scene's objects."""
    for item in scene.objects:
        if KEY in item and item.library is None:
            del item[KEY]


def scene_recording(scene: bpy.types.Scene) -> dict[str, Recorded]:
    """What was recorded of the scene's objects, by name; what cannot be read is left out."""
    found = {item.name: _decoded(item[KEY]) for item in scene.objects if isinstance(item.get(KEY), str)}
    return {name: recorded for name, recorded in found.items() if recorded is not None}


@lru_cache(maxsize=256)
def _decoded(text: str) -> Recorded | None:
    try:
        return recorded_from_json(text)
    except UniSGError:
        return None


def replay(graph: SceneGraph, scene: bpy.types.Scene | None = None, report: ReadReport | None = None) -> int:
    """Set the recording of a scenegraph as keyframes of the scene's objects of the same uids.

    Its events become timeline markers, triggers and forces keyframes of the tools.

    Returns
    -------
    int
        How many objects got keyframes; what they were animated with before is taken off them.

    Raises
    ------
    UniSGError
        If there is no recording, or none of its objects is in the scene.
    """
    scene = scene or bpy.context.scene
    found, events = graph.components.get(RECORDING), graph.components.get(EVENTS)
    if found is None and events is None:
        raise UniSGError("there is no recording in it")
    by_uid = objects_by_uid(scene)
    rows = sorted({int(row) for each in (found, events) if each is not None for row in each.rows})
    objects = {row: by_uid[graph.uid[row]] for row in rows if graph.uid[row] in by_uid}
    if not objects:
        raise UniSGError("none of the recorded objects is in this scene: did their identities change?")
    moving = {row: objects[row] for row in ([] if found is None else found.rows.tolist()) if row in objects}
    for item in moving.values():
        item.animation_data_clear()
    if found is not None:
        moved = in_scene_units(graph.with_component(ANIMATION, found), scene)
        write_animation(moved, moving, scene, ReadReport() if report is None else report)
    ends = [float(times[-1]) for times in (() if found is None else found.columns["times"])]
    ends.append(show_events(graph, objects, scene))
    scene.frame_end = max(scene.frame_end, math.ceil(max(ends) * frame_rate(scene)))
    return len(moving)
