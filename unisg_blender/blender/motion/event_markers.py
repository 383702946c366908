"""The events of a recording on Blender's timeline: markers, and keyframes of triggers and forces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import bpy

from ...behaviour import all_actions, recorded_inputs
from ...scene.components import EVENTS
from ...scene.graph import SceneGraph
from ..authoring.stored_behaviour import FORCE, TRIGGER
from ..fcurves import curves_of
from ..scene_frames import frame_rate

SHOWN = {"performed": "done", "early": "too early", "failed": "wrong"}
"""Words of a recording that become markers, and what these say."""


def show_events(graph: SceneGraph, objects: Mapping[int, bpy.types.Object], scene: bpy.types.Scene) -> float:
    """Show the events of a scenegraph in a scene; returns the time of the last one in seconds.

    The markers of an earlier recording go. An answer becomes a marker such as
    "How many swabs? = three", which :func:`~..authoring.stored_behaviour.scene_moments` understands.
    """
    for marker in [each for each in scene.timeline_markers if each.name.startswith(tuple(_heads()))]:
        scene.timeline_markers.remove(marker)
    rate = frame_rate(scene)
    last = 0.0
    for when, text in _texts(graph):
        frame = max(scene.frame_start, round(when * rate))
        if not any(each.name == text and each.frame == frame for each in scene.timeline_markers):
            scene.timeline_markers.new(text, frame=frame)
        last = max(last, when)
    inputs = recorded_inputs(graph)
    for row, item in objects.items():
        own = [each for each in inputs if each.uid == graph.uid[row]]
        start = float(scene.frame_start)
        _key(item, TRIGGER, [(each.time * rate, int(each.trigger)) for each in own if each.trigger is not None], start)
        _key(item, FORCE, [(each.time * rate, each.force) for each in own if each.force is not None], start)
    return max(last, *(each.time for each in inputs)) if inputs else last


def _heads() -> Iterator[str]:
    return (f"{shown}: " for shown in SHOWN.values())


def _texts(graph: SceneGraph) -> Iterator[tuple[float, str]]:
    actions = {action.uid: action for action in all_actions(graph)}
    for _, when, word, uid in graph.entries(EVENTS, "time", "event", "action"):
        if word in SHOWN and uid in actions:
            yield float(when), f"{SHOWN[word]}: {actions[uid].name or actions[uid].type}"
    for each in recorded_inputs(graph):
        if each.answer is not None and each.uid in actions:
            action = actions[each.uid]
            chosen = [action.answers[place] for place in each.answer if 0 <= place < len(action.answers)]
            yield each.time, f"{action.name or action.uid} = {', '.join(chosen)}"


def _key(item: bpy.types.Object, key: str, values: Sequence[tuple[float, float]], start: float) -> None:
    """Keyframes of a custom property, each holding until the next one, 0 before the first; earlier ones go."""
    path = f'["{key}"]'
    curves = curves_of(item)
    for curve in [each for each in curves or () if each.data_path == path]:
        curves.remove(curve)
    if not values:
        return
    first = [] if values[0][0] <= start else [(start, type(values[0][1])(0))]
    for frame, value in (*first, *values):
        item[key] = value
        item.keyframe_insert(path, frame=max(frame, start))
    for curve in curves_of(item) or ():
        for point in curve.keyframe_points if curve.data_path == path else ():
            point.interpolation = "CONSTANT"
