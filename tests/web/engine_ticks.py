"""Moments of a lesson as ticks for Babylon.js in Node, and what it tells of them."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.behaviour import Moment
from unisg_blender.formats.gltf.gltf_files import write_gltf
from unisg_blender.geometry.y_up import turned_matrices
from unisg_blender.interactivity import LessonGraph

Told = list[list[tuple[str, int]]]


def ticks_of(compiled: LessonGraph, moments: Iterable[Moment]) -> list[dict[str, Any]]:
    """What moves and what a learner does, tick by tick."""
    graph = compiled.lesson.graph
    known = {event["id"] for event in compiled.graph["events"]}
    world, pressed, force = graph.world, np.zeros(len(graph), bool), np.zeros(len(graph))
    found = []
    for moment in moments:
        now = np.asarray(moment.world)
        moved = np.flatnonzero(np.abs(now - world).max(axis=(1, 2)) > 0)
        matrices = turned_matrices(now)
        sent: list[tuple[str, dict[str, Any]]] = []
        for row in np.flatnonzero(moment.trigger != pressed).tolist():
            sent.append(("unisg:trigger", {"entity": row, "pressed": bool(moment.trigger[row])}))
        for row in np.flatnonzero(moment.force != force).tolist():
            sent.append(("unisg:force", {"entity": row, "newtons": float(moment.force[row])}))
        for uid, given in moment.answers.items():
            tasks = [task for task, action in enumerate(compiled.lesson.checks.actions) if action.uid == uid]
            chosen = sum(1 << place for place in set(given))
            sent += [("unisg:answer", {"task": task, "chosen": chosen}) for task in tasks[:1]]
        found.append({
            "time": moment.time,
            "moved": {int(row): matrices[row].T.ravel().tolist() for row in moved},
            "sent": [each for each in sent if each[0] in known],
        })  # fmt: skip
        world, pressed, force = now, moment.trigger, moment.force
    return found


def told_by_engine(compiled: LessonGraph, ticks: list[dict[str, Any]], player: str, folder: Path) -> tuple[Told, float]:
    """The events of each tick, as id and node of the outline, and the median of milliseconds that one takes."""
    return all_told_by_engine([(compiled, ticks)], player, folder)[0]


def all_told_by_engine(
    played: Sequence[tuple[LessonGraph, list[dict[str, Any]]]], player: str, folder: Path
) -> list[tuple[Told, float]]:
    """The same of several rooms, in one run of the engine."""
    words = ["node", "engine_test.mjs"]
    for number, (compiled, ticks) in enumerate(played):
        room, moves = folder / f"room {number}.glb", folder / f"ticks {number}.json"
        write_gltf(compiled.lesson.graph, room, whole=False)
        moves.write_text(json.dumps(ticks))
        words += [str(room), str(moves)]
    run = subprocess.run(words, cwd=player, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stderr
    records = [json.loads(line) for line in run.stdout.splitlines() if line.startswith("{")]
    return [
        (_told(compiled, record["told"]), record["milliseconds"])
        for (compiled, _), record in zip(played, records, strict=True)
    ]


def _told(compiled: LessonGraph, told: list[list[tuple[str, str, int]]]) -> Told:
    return [
        [(f"unisg:{event}", value if name == "node" else compiled.leaf_of(value)) for event, name, value in each]
        for each in told
    ]
