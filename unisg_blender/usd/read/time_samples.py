"""Motion, recordings and action events from time samples."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom

from ...scene import components
from ...scene.component_table import Table, table
from ...scene.frame_range import LONGEST
from ...scene.parents import LARGEST
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
            if not abs(moment / rate) <= LONGEST:
                continue
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
    return _clip(form.GetPrim(), times, rate, [form.GetLocalTransformation(Usd.TimeCode(moment)) for moment in times])


def _local_clip(attribute: Any, rate: float) -> Clip | None:
    times = attribute.GetTimeSamples()
    if not times:
        return None
    return _clip(attribute.GetPrim(), times, rate, [attribute.Get(moment) for moment in times])


def _clip(prim: Any, codes: list[float], rate: float, matrices: list[Any]) -> Clip | None:
    """Seconds, ascending, and matrices of samples; those that are no moments, or have no numbers, are left out."""
    times, first = np.unique(np.array(codes, np.float64) / rate, return_index=True)
    poses = from_usd(matrices)[first]
    sound = (np.abs(times) <= LONGEST) & (np.abs(poses) <= LARGEST).all(axis=(1, 2))
    if not sound.all():
        warnings.warn(f"{prim.GetPath()}: samples that are no moments or matrices; left out", stacklevel=2)
    return (times[sound], poses[sound]) if sound.any() else None


def _clip_table(clips: dict[int, Clip]) -> Table:
    return table(
        list(clips), times=[times for times, _ in clips.values()], matrices=[poses for _, poses in clips.values()]
    )
