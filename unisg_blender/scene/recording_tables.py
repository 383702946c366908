"""Recordings: how entities were moved and what was done meanwhile, as tables and as custom properties."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..runtime.json_records import check_version, parse_json
from .component_table import Table, entry_table
from .components import EVENTS, RECORDING
from .graph import SceneGraph

VERSION = 1
KEY = "unisg_recording"
"""The custom property that holds what was recorded of an object."""

RecordedEvent = tuple[float, str, str]
"""Seconds, one word, and the uid of an action ("" where the word is about the entity): see ``components.EVENTS``."""

_NO_TIMES: NDArray[np.float64] = np.zeros(0)


@dataclass(frozen=True, eq=False)
class Recorded:
    """What was recorded of one entity: ``times`` (T,) in seconds, ``matrices`` (T, 4, 4) local, events."""

    times: NDArray[np.float64] = field(default_factory=lambda: _NO_TIMES)
    matrices: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 4, 4)))
    events: tuple[RecordedEvent, ...] = ()


def recorded_to_json(recorded: Recorded) -> str:
    """The value of the custom property: a JSON object with ``times``, ``poses`` (12 numbers each) and ``events``."""
    record: dict[str, Any] = {"version": VERSION}
    if len(recorded.times):
        record["times"] = recorded.times.tolist()
        record["poses"] = recorded.matrices[:, :3].reshape(-1, 12).tolist()
    if recorded.events:
        record["events"] = [list(event) for event in recorded.events]
    return json.dumps(record, ensure_ascii=False)


def recorded_from_json(text: str) -> Recorded:
    """What was recorded, from the value of the custom property.

    Raises
    ------
    UniSGError
        If the text is no JSON object of that form, or was written by a newer version.
    """
    try:
        record = parse_json(text, "it")
        version = record.get("version", VERSION)
        times, poses = np.array(record.get("times", []), np.float64), np.array(record.get("poses", []), np.float64)
        events = tuple((float(when), str(word), str(uid)) for when, word, uid in record.get("events", []))
        poses = poses.reshape(len(times), 3, 4)
    except (UniSGError, ValueError, TypeError, AttributeError) as error:
        raise UniSGError(f"{KEY} is not of the form that docs/behaviour.md describes: {error}") from None
    check_version(version, "this recording has", VERSION)
    finite = np.isfinite(times).all() and np.isfinite(poses).all() and all(math.isfinite(when) for when, _, _ in events)
    if not finite or (np.diff(times) <= 0).any():
        raise UniSGError(f"{KEY} must have finite numbers and ascending times")
    below = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (len(times), 1, 4))
    return Recorded(times, np.concatenate([poses, below], axis=1), events)


def recorded_of(graph: SceneGraph, row: int) -> Recorded | None:
    """What was recorded of an entity; None if nothing was."""
    clips = graph.entries(RECORDING, "times", "matrices", row=row)
    happened = graph.entries(EVENTS, "time", "event", "action", row=row)
    if not clips and not happened:
        return None
    events = tuple((float(when), str(word), str(uid)) for _, when, word, uid in happened)
    return Recorded(clips[0][1], clips[0][2], events) if clips else Recorded(events=events)


def recording_tables(rows: Sequence[Recorded | None]) -> dict[str, Table]:
    """Component tables ``recording`` and ``events`` from one record per row, those that have entries."""
    clips = ((row, each.times, each.matrices) for row, each in enumerate(rows) if each is not None and len(each.times))
    happened = ((row, event) for row, each in enumerate(rows) if each is not None for event in each.events)
    tables = {EVENTS: event_table(happened), RECORDING: entry_table(clips, "times", "matrices")}
    return {name: found for name, found in tables.items() if len(found.rows)}


def event_table(happened: Iterable[tuple[int, RecordedEvent]]) -> Table:
    """The component table ``events`` from pairs of a row and an event."""
    found = entry_table(((row, *event) for row, event in happened), "time", "event", "action")
    return Table(found.rows, {**found.columns, "time": found.columns["time"].astype(np.float64)})
