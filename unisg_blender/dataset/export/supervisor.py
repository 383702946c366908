"""Have a file read by a process of its own, under a time limit, whoever runs us: a thread, a process or a cluster."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...runtime.atomic_files import DamagedError, check_plain, checksum, checksum_of
from ...runtime.process_end import ended_by
from ...runtime.process_pool import blender_program
from ..assets.asset_file import Arrays, Assets
from ..format.columns import Columns
from ..format.shards import map_shard
from .file_checksums import unchanged
from .reader_process import ALIVE, ASSETS, MARK

ROOT = Path(__file__).parents[2]
"""Folder that the library lies in."""

START_LIMIT = 180.0
FILES_PER_CHILD = 200
SETTINGS = (
    "source",
    "label",
    "form",
    "mapping",
    "understand",
    "instances",
    "reader",
    "mesh_encoder",
    "software",
    "assets",
)
"""What, beside a file's bytes, decides what is written of it."""


class Child:
    """A process that opens files; see :mod:`.reader_process`."""

    def __init__(self, memory: int) -> None:
        self.files = 0
        self._late = False
        self._folder = tempfile.TemporaryDirectory(prefix="unisg-", ignore_cleanup_errors=True)
        self._errors = open(Path(self._folder.name, "errors"), "w+b")  # noqa: SIM115 (closed by end)
        self._process = subprocess.Popen(
            child_command(memory, self._folder.name),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            env=os.environ
            | dict.fromkeys(("TMPDIR", "TMP", "TEMP"), self._folder.name),  # Blender leaves objects there
            encoding="utf-8",
            errors="replace",
        )
        _alive.add(self)
        self.ready = self._next_answer(START_LIMIT).get("status") == "ready"

    def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Its answer to a request; {} if it ends before it gives one, or is ended because it is too late."""
        assert self._process.stdin is not None
        self.files += 1
        with contextlib.suppress(OSError):  # it is gone: then there is no answer either
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()
        return self._next_answer(request["timeout"])

    def _next_answer(self, limit: float) -> dict[str, Any]:
        assert self._process.stdout is not None
        timer = self._clock(limit)
        try:
            for line in self._process.stdout:
                if line.startswith(MARK):
                    answer = json.loads(line[len(MARK) :])
                    if answer.get("status") != ALIVE:
                        return answer
                    timer.cancel()
                    timer = self._clock(limit)
            self._process.wait()
            return {}
        finally:
            timer.cancel()

    def _clock(self, limit: float) -> threading.Timer:
        timer = threading.Timer(limit, self._kill_late)
        timer.start()
        return timer

    def _kill_late(self) -> None:
        self._late = True
        self._process.kill()

    def fate(self, limit: float) -> str:
        """Why it ended."""
        code = self._process.wait()
        if self._late:
            return f"not done after {limit:g} s: raise the time limit, or leave the file out"
        self._errors.seek(0)
        lines = [line.strip() for line in self._errors.read().decode("utf-8", "replace").splitlines() if line.strip()]
        last = f": {lines[-1]}" if lines else ""
        if code < 0:
            return f"the reading process {ended_by(code)}{last}"
        return f"the reading process ended with status {code}{last}"

    @property
    def retired(self) -> bool:
        """Whether it went away by itself, because nobody asked for anything."""
        return self._process.poll() == 0 and not self._late

    def stop(self) -> None:
        """Kill it."""
        self._process.kill()

    def end(self) -> None:
        """Kill it, wait for its end and give everything back."""
        self._process.kill()
        self._process.wait()
        self._errors.close()
        for stream in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):
                stream.close()  # type: ignore[union-attr]
        self._folder.cleanup()
        _alive.discard(self)


_idle: defaultdict[int, queue.LifoQueue[Child]] = defaultdict(queue.LifoQueue)
_alive: set[Child] = set()


def child_command(memory: int, folder: str) -> list[str]:
    """How to start a process that serves; inside Blender, another Blender.

    There the library is ``unisg_blender``, whatever it is called here, and finds
    its packages where this process does: an extension has them in a place of its own.
    """
    application = blender_program()
    paths = [str(ROOT), *filter(None, sys.path)]
    code = f"import sys; sys.path += [path for path in {paths!r} if path not in sys.path]; "
    code += f"from unisg_blender.dataset.export.reader_process import main; main({memory}, {folder!r})"
    if not application:
        return [sys.executable, "-c", code]
    return [application, "--background", "--factory-startup", "--python-expr", code]


def export_file(job: dict[str, Any]) -> dict[str, Any]:
    """Read one file and write its scenes to the folder ``job["parts"]``.

    Plain records in and out, so that any :class:`concurrent.futures.Executor` can run it.

    Parameters
    ----------
    job
        ``path``, ``parts``, ``known`` and ``beside`` (key of what the dataset has of this
        file already, or "", and checksums of the files beside it then), ``timeout``
        (seconds), ``memory`` (bytes, 0 for no limit),
        and the :data:`SETTINGS`, of which ``source`` is the file's name in the dataset.

    Returns
    -------
    dict
        ``status`` is "ok" (with ``part``, a file in the folder, and counts),
        "same" (the dataset has it), "failed" (with ``reason``) or "full" (the disk is).
    """
    record: dict[str, Any] = {"source": job["source"]}
    try:
        check_plain(Path(job["path"]))
        with open(job["path"], "rb") as file:
            record["sha256"] = hashlib.file_digest(file, "sha256").hexdigest()
            record["bytes"] = file.tell()
    except OSError as error:
        return record | {"status": "failed", "reason": f"cannot be read: {error.strerror or error}"}
    settings = [record["sha256"], {name: job[name] for name in SETTINGS}]
    record["key"] = checksum(json.dumps(settings, sort_keys=True).encode())[:32]
    if record["key"] == job["known"] and unchanged(Path(job["path"]), job["beside"]):
        return record | {"status": "same"}
    return record | (_earlier_answer(job, record["key"]) or _ask(job | {"key": record["key"]}))


def _earlier_answer(job: dict[str, Any], key: str) -> dict[str, Any] | None:
    """The answer of an interrupted export, if its part is there and whole, and the files beside are what they were."""
    for path in Path(job["parts"]).glob(f"{key}-*.safetensors"):
        with contextlib.suppress(DamagedError):
            answer = read_part(path).answer
            if unchanged(Path(job["path"]), answer["beside"]):
                return answer | {"part": path.name}
        path.unlink(missing_ok=True)
    return None


@dataclass(frozen=True)
class ReadPart:
    """What was read of one file: its scenes, what their numbers mean, and what was collected of their geometry."""

    columns: Columns
    vocabulary: dict[str, list[str]]
    assets: Assets
    answer: dict[str, Any]


def read_part(path: Path) -> ReadPart:
    """A part; DamagedError if it is not what its name says.

    Columns are in memory, arrays of assets when they are fetched: the file stays open as long as the part is in use.
    """
    if not path.stem.endswith(checksum_of(path)[:16]):
        raise DamagedError(f"{path} is damaged: resume the export")
    shard = map_shard(path)
    notes = shard.notes
    columns = {key: np.array(values) for key, values in shard.columns.items() if not key.startswith(ASSETS)}

    def fetch(names: Iterable[str]) -> Arrays:
        """The arrays of those assets that the shard has."""
        return {name: np.array(shard.columns[ASSETS + name]) for name in names if ASSETS + name in shard.columns}

    return ReadPart(columns, notes["vocabulary"], Assets(notes["assets"], fetch), notes["answer"])


def _ask(job: dict[str, Any]) -> dict[str, Any]:
    """Ask a waiting process, or a new one, to read the file."""
    waiting = _idle[job["memory"]]
    while True:
        try:
            child = waiting.get_nowait()
        except queue.Empty:
            child = Child(job["memory"])
        answer = child.ask(job) if child.ready else {}
        if answer and child.files < FILES_PER_CHILD and not answer.pop("tired", False):
            waiting.put(child)
            return answer
        again = not answer and child.files > 1 and child.retired
        reason = "" if answer else child.fate(job["timeout"] if child.ready else START_LIMIT)
        child.end()
        if not again:
            return answer or {"status": "failed", "reason": reason}


def close_children() -> None:
    """End all processes that read files for this one."""
    for child in list(_alive):
        child.stop()  # who waits for it sees it end
    for waiting in _idle.values():
        with contextlib.suppress(queue.Empty):
            while True:
                waiting.get_nowait().end()
