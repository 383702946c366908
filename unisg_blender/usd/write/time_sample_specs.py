"""Motion, recordings and action events as time samples."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pxr import Vt

from ...scene import components
from ...scene.component_table import Table
from ...scene.graph import SceneGraph
from .. import schema
from ..names import clean
from .specs import Types, custom, matrices

FRAME_RATE = 24.0
"""Time codes per second; a frame may fall between two whole ones."""


def set_frame_rate(graph: SceneGraph, layer: Any) -> None:
    """Tell the layer how long the motion lasts, if there is any."""
    times = [
        moment
        for name in (components.ANIMATION, components.RECORDING)
        if name in graph.components
        for clip in graph.components[name].columns["times"]
        if len(clip)
        for moment in (clip[0], clip[-1])
    ]
    if components.EVENTS in graph.components:
        times += graph.components[components.EVENTS].columns["time"].tolist()
    if times:
        layer.timeCodesPerSecond = layer.framesPerSecond = FRAME_RATE
        layer.startTimeCode, layer.endTimeCode = min(times) * FRAME_RATE, max(times) * FRAME_RATE


def write_motion(prims: Sequence[Any], graph: SceneGraph) -> None:
    """Author animation on the transforms, recordings there too where nothing else moves the entity, and events."""
    tables = graph.components
    moved = set(tables[components.WORLD].rows.tolist()) if components.WORLD in tables else set()
    animated = _clips(tables.get(components.ANIMATION))
    for row, (times, poses) in animated.items():
        _sample(prims[row].attributes[schema.LOCAL if row in moved else schema.TRANSFORM], times, poses)
    for row, (times, poses) in _clips(tables.get(components.RECORDING)).items():
        if row in animated or row in moved:
            spec = custom(prims[row], schema.RECORDING, Types.Matrix4d, None, uniform=False)
        else:
            custom(prims[row], schema.RECORDED, Types.Bool, True)
            spec = prims[row].attributes[schema.TRANSFORM]
        _sample(spec, times, poses)
    _write_events(prims, tables.get(components.EVENTS))


def _clips(found: Table | None) -> dict[int, tuple[Any, Any]]:
    if found is None:
        return {}
    return dict(
        zip(found.rows.tolist(), zip(found.columns["times"], found.columns["matrices"], strict=True), strict=True)
    )


def _sample(spec: Any, times: Any, poses: Any) -> None:
    layer, path = spec.layer, spec.path
    for moment, pose in zip((np.asarray(times) * FRAME_RATE).tolist(), matrices(poses), strict=True):
        layer.SetTimeSample(path, moment, pose)


def _write_events(prims: Sequence[Any], events: Table | None) -> None:
    for row, found in () if events is None else events.groups():
        spec = custom(prims[row], schema.EVENTS, Types.StringArray, None, uniform=False)
        for moment in dict.fromkeys(found["time"].tolist()):
            now = np.flatnonzero(found["time"] == moment)
            words = [clean(f"{found['event'][item]} {found['action'][item]}") for item in now]
            spec.layer.SetTimeSample(spec.path, moment * FRAME_RATE, Vt.StringArray(words))
