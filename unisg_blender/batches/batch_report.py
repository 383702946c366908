"""The report of a batch: a line for each room, from which a later call knows what is made already."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ..dataset.format.writer import MANIFEST
from ..errors import UniSGError
from ..runtime.atomic_files import replacing
from ..runtime.json_records import parse_json
from .batch_plan import PICTURES, Task
from .pictures.picture_worker import FOLDERS

REPORT = "report.jsonl"
"""A line for each room: what it is, or why it failed."""


def write_report(folder: Path, records: Iterable[Mapping[str, Any]]) -> None:
    """Write the report, whole or not at all."""
    with replacing(folder / REPORT) as unfinished, open(unfinished, "w", encoding="utf-8", newline="\n") as file:
        file.writelines(json.dumps(record, sort_keys=True) + "\n" for record in records)


def read_report(folder: Path) -> list[dict[str, Any]]:
    """The records of a folder; none where it has no report.

    Raises
    ------
    UniSGError
        If the report cannot be read.
    """
    path = folder / REPORT
    if not path.is_file():
        return []
    with open(path, encoding="utf-8", errors="replace") as file:
        records = [parse_json(line, str(path)) for line in file]
    for record in records:
        if not (isinstance(record, dict) and {"source", "status"} <= record.keys()):
            raise UniSGError(f"{path} is no report of a batch: choose another folder")
    return records


def other_records(folder: Path, tasks: Sequence[Task], kind: str) -> list[dict[str, Any]]:
    """The records of what earlier batches made in a folder, and a batch of these tasks and this format does not.

    A dataset, and pictures, are in place of what was there of their kind; files stand beside others.
    """
    files, rooms = {f"{task['room']}.{kind}" for task in tasks}, {task["room"] for task in tasks}

    def other(record: Mapping[str, Any]) -> bool:
        """Whether a record is of a room that this batch does not make."""
        if "file" in record:
            return record["file"] not in files and (folder / record["file"]).is_file()
        return kind not in ("dataset", PICTURES) and record["source"] not in rooms

    return list(filter(other, read_report(folder)))


class MadeBefore:
    """What a finished batch has made in a folder, by the keys of its jobs; nothing unless it is to be ``resumed``."""

    def __init__(self, folder: Path, resumed: bool) -> None:
        self.folder = folder
        self.whole = (folder / MANIFEST).is_file()
        self._records: dict[str, list[dict[str, Any]]] = {}
        for record in read_report(folder) if resumed else ():
            self._records.setdefault(record.get("key", ""), []).append(record)

    def answer(self, job: Mapping[str, Any]) -> dict[str, Any] | None:
        """The answer for a job whose rooms are all there, None if one is not."""
        records = self._records.get(job["key"], ())
        there = self.whole if job["format"] == "dataset" else all(map(self._is_there, records))
        made = len(records) == len(job["tasks"]) and all(record["status"] == "ok" for record in records)
        return {"number": job["number"], "records": records, "part": ""} if made and there else None

    def _is_there(self, record: Mapping[str, Any]) -> bool:
        """Whether all files of a room are there."""
        names = [record["file"]] if "file" in record else []
        names += [f"{kind}/{name}{end}" for name in record.get("pictures", ()) for kind, end in FOLDERS.items()]
        return all((self.folder / name).is_file() for name in names)

    def all_answers(self, jobs: Iterator[dict[str, Any]]) -> list[dict[str, Any]] | None:
        """The answers for jobs that have all been done, None if one has not."""
        found = []
        for job in jobs:
            if (answer := self.answer(job)) is None:
                return None
            found.append(answer)
        return found
