"""Motion as JSON: a script that people write by hand, by the names of the scene's objects."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError, did_you_mean
from ...poses import FORMS
from ...runtime.json_records import check_version, parse_json
from ...scene.graph import SceneGraph
from ...scene.hierarchy import world_matrices
from ..lesson.action_places import all_actions
from .motion_tracks import PARENT, WORLD, Input, Motion, Track

VERSION = 1


def motion_to_json(graph: SceneGraph, motion: Motion) -> str:
    """A motion as JSON; entities and actions by uid."""
    form = FORMS["quaternion"]
    tracks = []
    for track in motion.tracks:
        rows = form.encode(track.matrices, stretch=True)
        whole = not np.allclose(rows[:, form.width :], [1, 1, 1, 0, 0, 0], atol=1e-12)
        keys = [
            {"time": float(time), "matrix": matrix.ravel().tolist()}
            if whole
            else {"time": float(time), "position": row[:3].tolist(), "rotation": row[3:7].tolist()}
            for time, row, matrix in zip(track.times, rows, track.matrices, strict=True)
        ]
        name = graph.name[graph.row_of_uid[track.uid]] if track.uid in graph.row_of_uid else ""
        frame = {PARENT: "parent", WORLD: "world"}.get(track.frame, track.frame)
        tracks.append({"entity": track.uid, "name": name, "frame": frame, "keys": keys})
    inputs = []
    for each in motion.inputs:
        said = {"trigger": each.trigger, "force": each.force, "answer": each.answer}
        said = {key: value for key, value in said.items() if value is not None}
        inputs.append({"time": each.time, "action" if each.answer is not None else "entity": each.uid} | said)
    return json.dumps({"version": VERSION, "rate": motion.rate, "tracks": tracks, "inputs": inputs}, ensure_ascii=False)


def motion_from_json(graph: SceneGraph, text: str) -> Motion:
    """A motion from JSON: see docs/behaviour.md for its form.

    Raises
    ------
    UniSGError
        If the text is not of that form, or names what is not in the scene.
    """
    record = parse_json(text, "the motion")
    if not isinstance(record, dict):
        raise UniSGError("a motion must be a JSON object with tracks and inputs")
    check_version(record.get("version", VERSION), "this motion has", VERSION)
    try:
        rate = float(record.get("rate", 30.0))
        tracks = tuple(_track(graph, each) for each in record.get("tracks", ()))
        inputs = tuple(_input(graph, each) for each in record.get("inputs", ()))
    except UniSGError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise UniSGError(f"the motion is not of the form that docs/behaviour.md describes: {error!r}") from None
    if not 0 < rate < math.inf:
        raise UniSGError("the rate of a motion must be a positive number of frames per second")
    if not {"tracks", "inputs"} & record.keys():
        raise UniSGError("a motion has tracks, or inputs, and this has neither: docs/behaviour.md describes its form")
    return Motion(tracks, inputs, rate)


def _track(graph: SceneGraph, record: Mapping[str, Any]) -> Track:
    uid = _entity(graph, record["entity"])
    frame = record.get("frame", "world")
    keys = sorted(record["keys"], key=lambda key: float(key["time"]))
    if not keys:
        raise UniSGError(f"the track of {record['entity']!r} has no keys")
    times = np.array([float(key["time"]) for key in keys])
    if not np.isfinite(times).all() or (np.diff(times) <= 0).any():
        raise UniSGError(f"the track of {record['entity']!r} has two keys at one time")
    row = graph.row_of_uid[uid]
    rest = graph.local[row] if frame == "parent" else world_matrices(graph)[row]
    matrices = np.array([_matrix(key, rest) for key in keys])
    return Track(uid, times, matrices, {"parent": PARENT, "world": WORLD}.get(frame) or _frame(graph, frame))


def _frame(graph: SceneGraph, frame: str) -> str:
    return WORLD if frame == "world" else _entity(graph, frame)


def _matrix(key: Mapping[str, Any], rest: NDArray[np.float64]) -> NDArray[np.float64]:
    """A key's pose; what it does not say (rotation, scale) is as the scene has it."""
    if "matrix" in key:
        return _finite(key["matrix"], 16).reshape(4, 4)
    form = FORMS["quaternion"]
    row = form.encode(rest, stretch=True)
    row[:3] = _finite(key["position"], 3)
    if "rotation" in key:
        row[3:7] = form.project(np.concatenate([row[:3], _finite(key["rotation"], 4)]))[3:]
    return form.decode(row, stretch=True)


def _finite(values: Any, count: int) -> NDArray[np.float64]:
    numbers = np.array(values, np.float64).reshape(count)
    if not np.isfinite(numbers).all():
        raise UniSGError("a key of the motion has a number that is not finite")
    return numbers


def _input(graph: SceneGraph, record: Mapping[str, Any]) -> Input:
    time = float(record["time"])
    if "answer" in record:
        actions = all_actions(graph)
        found = [action for action in actions if record["action"] in (action.uid, action.name)]
        if not found:
            hint = did_you_mean(str(record["action"]), (action.name for action in actions))
            raise UniSGError(f"the motion answers {record['action']!r}, which is no action of the scene{hint}")
        answers = found[0].answers
        chosen = tuple(answers.index(each) if isinstance(each, str) else int(each) for each in record["answer"])
        return Input(time, found[0].uid, answer=chosen)
    trigger, force = record.get("trigger"), record.get("force")
    return Input(time, _entity(graph, record["entity"]), trigger, None if force is None else float(force))


def _entity(graph: SceneGraph, key: str) -> str:
    if key in graph.row_of_uid:
        return key
    if key in graph.name:
        return graph.uid[graph.name.index(key)]
    raise UniSGError(f"the motion names {key!r}, which is not in the scene{did_you_mean(key, graph.name)}")
