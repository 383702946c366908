"""Motion, recordings and action events from time samples."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom

from ...scene import components
from ...scene.component_table import Table, table
from .. import schema
from .entity_selection import Entities
from .xforms import Frames, from_usd

Clip = tuple[NDArray[np.float64], NDArray[np.float64]]


def read_motion(found: Entities, frames: Frames, rate: float) -> dict[str, Table]:
    """Components ``animation``, ``recording`` and ``events``; ``rate`` is the stage's time codes per second."""
    animated: dict[int, Clip] = {}
    recorded: dict[int, Clip] = {}
    events: list[tuple[int, float, str, str]] = []
    moved = frames.tables.get(components.WORLD)
    fixed = set() if moved is None else set(moved.rows.tolist())
    for row, prim in enumerate(found.prim):
        form = UsdGeom.Xformable(prim)
        local = prim.GetAttribute(schema.LOCAL) if row in fixed else None
        clip = _local_clip(local, rate) if local else (_transform_clip(form, rate) if form else None)
        if clip is not None:
            target = recorded if prim.HasAttribute(schema.RECORDED) else animated
            target[row] = clip[0], frames.turned(row, clip[1])
        attribute = prim.GetAttribute(schema.RECORDING)
        if attribute and (clip := _local_clip(attribute, rate)) is not None:
            recorded[row] = clip[0], frames.turned(row, clip[1])
        attribute = prim.GetAttribute(schema.EVENTS)
        for moment in attribute.GetTimeSamples() if attribute else ():
            for text in attribute.Get(moment):
                word, _, uid = text.partition(" ")
                events.append((row, moment / rate, uid, word))
    tables = {components.ANIMATION: _clip_table(animated), components.RECORDING: _clip_table(recorded)}
    if events:
        rows, times, uids, words = (list(column) for column in zip(*events, strict=True))
        tables[components.EVENTS] = table(rows, time=np.array(times), action=uids, event=words)
    return {name: found for name, found in tables.items() if len(found.rows)}


def _transform_clip(form: Any, rate: float) -> Clip | None:
    if not form.TransformMightBeTimeVarying() or form.GetResetXformStack():
        return None
    times = form.GetTimeSamples()
    if not times:
        return None
    poses = [form.GetLocalTransformation(Usd.TimeCode(moment)) for moment in times]
    return np.array(times) / rate, from_usd(poses)


def _local_clip(attribute: Any, rate: float) -> Clip | None:
    times = attribute.GetTimeSamples()
    if not times:
        return None
    return np.array(times) / rate, from_usd([attribute.Get(moment) for moment in times])


def _clip_table(clips: dict[int, Clip]) -> Table:
    return table(
        list(clips), times=[times for times, _ in clips.values()], matrices=[poses for _, poses in clips.values()]
    )
