"""Motion, recordings and action events as time samples."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pxr import Vt

from ...scene import components
from ...scene.component_table import Table
from ...scene.frame_range import FrameRange, frames_at
from ...scene.graph import SceneGraph
from .. import schema
from ..names import clean
from .specs import Types, custom, matrices


def write_frame_range(frames: FrameRange, scene: Any) -> None:
    """Tell the layer of the scene's prim which frames there are and how fast they play."""
    layer = scene.layer
    layer.timeCodesPerSecond = layer.framesPerSecond = frames.rate
    layer.startTimeCode, layer.endTimeCode = frames.start, frames.end
    custom(scene, schema.FRAME, Types.Double, frames.frame)


def write_motion(prims: Sequence[Any], graph: SceneGraph, rate: float) -> None:
    """Author animation on the transforms, recordings there too where nothing else moves the entity, and events.

    ``rate`` is the number of time codes per second.
    """
    tables = graph.components
    moved = set(tables[components.WORLD].rows.tolist()) if components.WORLD in tables else set()
    animated = _clips(tables.get(components.ANIMATION))
    for row, (times, poses) in animated.items():
        spec = prims[row].attributes[schema.LOCAL if row in moved else schema.TRANSFORM]
        _sample(spec, frames_at(times, rate), poses)
    for row, (times, poses) in _clips(tables.get(components.RECORDING)).items():
        if row in animated or row in moved:
            spec = custom(prims[row], schema.RECORDING, Types.Matrix4d, None, uniform=False)
        else:
            custom(prims[row], schema.RECORDED, Types.Bool, True)
            spec = prims[row].attributes[schema.TRANSFORM]
        _sample(spec, frames_at(times, rate), poses)
    _write_events(prims, tables.get(components.EVENTS), rate)


def _clips(found: Table | None) -> dict[int, tuple[Any, Any]]:
    if found is None:
        return {}
    return dict(
        zip(found.rows.tolist(), zip(found.columns["times"], found.columns["matrices"], strict=True), strict=True)
    )


def _sample(spec: Any, codes: Sequence[float], poses: Any) -> None:
    layer, path = spec.layer, spec.path
    for code, pose in zip(codes, matrices(poses), strict=True):
        layer.SetTimeSample(path, code, pose)


def _write_events(prims: Sequence[Any], events: Table | None, rate: float) -> None:
    for row, found in () if events is None else events.groups():
        spec = custom(prims[row], schema.EVENTS, Types.StringArray, None, uniform=False)
        for moment in dict.fromkeys(found["time"].tolist()):
            now = np.flatnonzero(found["time"] == moment)
            words = [clean(f"{found['event'][item]} {found['action'][item]}") for item in now]
            spec.layer.SetTimeSample(spec.path, frames_at([moment], rate)[0], Vt.StringArray(words))
