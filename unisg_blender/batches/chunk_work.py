"""Have the rooms of a job made by a process of its own; a room over which it crashes or hangs costs only itself."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..dataset.export.supervisor import read_part
from ..runtime.asked_process import ask
from ..runtime.atomic_files import DamagedError, checksum_of
from ..runtime.serving_process import handle
from .task_records import failed

TRIES = 2
"""Times that a process may end over a room before the room is left out: the first may be somebody's kill."""


def make_chunk(job: dict[str, Any]) -> dict[str, Any]:
    """Make the rooms of a job, unless an interrupted batch has made them.

    Plain records in and out, so that any :class:`concurrent.futures.Executor` can run it.

    Returns
    -------
    dict
        ``source`` of the job, ``status`` "ok" or "full" (the disk is, with ``reason``), ``records`` of all rooms,
        ``part`` (see :func:`.room_worker.make_rooms`).
    """
    answer = earlier_answer(job) or _new_answer(job)
    for record in answer.get("records", ()):
        record["key"] = job["key"]
    return {"source": job["source"], "number": job["number"], **answer}


def _new_answer(job: dict[str, Any]) -> dict[str, Any]:
    """The answer of a process; rooms over which it ends again are left out."""
    left_out: dict[str, str] = {}
    ended: dict[int, int] = {}
    while True:
        answer = (handle if job["here"] else ask)(job | {"left_out": left_out})
        if answer["status"] != "failed":
            return answer
        number = answer["how_far"][0] if answer["how_far"] else 0
        if number >= len(job["tasks"]):  # all are made, and cannot be written
            records = [failed(task, answer["reason"]) for task in job["tasks"]]
            return {"status": "ok", "records": records, "part": ""}
        ended[number] = ended.get(number, 0) + 1
        if ended[number] == TRIES:
            left_out[str(number)] = answer["reason"]


def earlier_answer(job: Mapping[str, Any]) -> dict[str, Any] | None:
    """The answer of an interrupted batch, if what it made is there and whole."""
    if not job["made"]:
        return None
    path = Path(job["parts"], job["made"])
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError, DamagedError):
        if path.suffix == ".safetensors":
            return {"status": "ok", "records": read_part(path).answer["records"], "part": path.name}
        made = json.loads(path.read_text(encoding="utf-8"))
        if part := made.get("part", ""):
            read_part(path.with_name(part))  # DamagedError if it is not whole
        if all(checksum_of(Path(job["folder"], name)) == total for name, total in made["files"].items()):
            return {"status": "ok", "records": made["records"], "part": part}
    return None
