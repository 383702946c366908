"""Have work done by a process of its own, under a time limit, whoever runs us: a thread, a process or a cluster."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
from collections import defaultdict
from pathlib import Path
from typing import Any

from .process_end import ended_by
from .process_pool import THREADS, blender_program
from .serving_process import ALIVE, MARK

ROOT = Path(__file__).parents[2]
"""Folder that the library lies in."""

START_LIMIT = 180.0
REQUESTS_PER_CHILD = 200


class Child:
    """A process that answers; see :mod:`.serving_process`."""

    def __init__(self, memory: int) -> None:
        self.requests = 0
        self.how_far: list[int] = []
        self._late = False
        self.stopped = False
        self._folder = tempfile.TemporaryDirectory(prefix="unisg-", ignore_cleanup_errors=True)
        self._errors = open(Path(self._folder.name, "errors"), "w+b")  # noqa: SIM115 (closed by end)
        self._process = subprocess.Popen(
            child_command(memory, self._folder.name),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            env=dict.fromkeys(THREADS, "1")
            | os.environ
            | dict.fromkeys(("TMPDIR", "TMP", "TEMP"), self._folder.name),  # Blender leaves objects there
            encoding="utf-8",
            errors="replace",
        )
        _alive.add(self)
        self.ready = self._next_answer(START_LIMIT).get("status") == "ready"

    def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Its answer to a request; {} if it ends before it gives one, or is ended because it is too late."""
        assert self._process.stdin is not None
        self.requests, self.how_far = self.requests + 1, []
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
                    self.how_far = answer["how_far"]
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
            return f"its process {ended_by(code)}{last}"
        return f"its process ended with status {code}{last}"

    @property
    def retired(self) -> bool:
        """Whether it went away by itself, because nobody asked for anything."""
        return self._process.poll() == 0 and not self._late

    def stop(self) -> None:
        """Kill it, since nobody waits for its work any more."""
        self.stopped = True
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
    code += f"from unisg_blender.runtime.serving_process import main; main({memory}, {folder!r})"
    if not application:
        return [sys.executable, "-c", code]
    return [application, "--background", "--factory-startup", "--python-expr", code]


def ask(job: dict[str, Any]) -> dict[str, Any]:
    """The answer of a waiting process, or of a new one, to a request, see :mod:`.serving_process`.

    Plain records in and out, so that any :class:`concurrent.futures.Executor` can run it. A process that crashes,
    or gives no answer within ``job["timeout"]`` seconds, becomes a "failed" with the ``reason`` and ``how_far`` it was,
    one that :func:`close_children` ended a "stopped".
    """
    waiting = _idle[job["memory"]]
    while True:
        try:
            child = waiting.get_nowait()
        except queue.Empty:
            child = Child(job["memory"])
        answer = child.ask(job) if child.ready else {}
        if answer.get("status") == "failed":
            answer["how_far"] = child.how_far
        if answer and child.requests < REQUESTS_PER_CHILD and not answer.pop("tired", False):
            waiting.put(child)
            return answer
        again = not answer and child.requests > 1 and child.retired
        reason = "" if answer else child.fate(job["timeout"] if child.ready else START_LIMIT)
        child.end()
        if not again:
            status = "stopped" if child.stopped else "failed"
            return answer or {"status": status, "reason": reason, "how_far": child.how_far}


def close_children() -> None:
    """End all processes that work for this one."""
    for child in list(_alive):
        child.stop()  # who waits for it sees it end
    for waiting in _idle.values():
        with contextlib.suppress(queue.Empty):
            while True:
                waiting.get_nowait().end()
