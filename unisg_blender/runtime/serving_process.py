"""A process that answers requests: one per line on stdin, one answer per line on stdout.

It is a process of its own because Blender may crash, hang or run out of memory
over a file: that costs this process and that file, nothing else.
"""

from __future__ import annotations

import errno
import faulthandler
import importlib
import json
import os
import queue
import shutil
import sys
import threading
from collections.abc import Callable
from typing import Any, TextIO

from ..errors import UniSGError
from .atomic_files import DiskFullError
from .process_end import end_process

MARK = "unisg-answer "
"""Starts every answer: what else a library prints to stdout is not ours."""

ALIVE = "alive"
"""Status of an answer that is none yet: the work goes on."""

IDLE = 60.0
GRACE = 30.0

Request = dict[str, Any]
"""JSON-ready; ``work`` names the :data:`Work` that is asked for, ``timeout`` is in seconds."""

Alive = Callable[..., None]
"""Says that the work goes on, which gives it its time anew; numbers say how far it has come."""

Work = Callable[[Request, Alive], dict[str, Any]]
"""What a process can be asked to do: "package.module:function"."""


def load_function(name: str) -> Callable[..., Any]:
    """The function behind "package.module:name".

    Raises
    ------
    UniSGError
        If there is none.
    """
    module, _, attribute = name.partition(":")
    try:
        return getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, ValueError) as error:
        raise UniSGError(f"{name!r} is no function (package.module:name): {error}") from None


def serve(memory: int, folder: str) -> None:
    """Answer requests until stdin ends or nothing is asked for a minute.

    ``memory`` limits it to so many bytes; ``folder`` is where it keeps temporary files, removed when stdin ends.
    """
    channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what Blender prints must not get between the answers
    if memory:
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    requests: queue.Queue[str] = queue.Queue()
    threading.Thread(target=_listen, args=(requests, folder), daemon=True).start()
    _answer(channel, {"status": "ready"})
    while True:
        try:
            request = json.loads(requests.get(timeout=IDLE))
        except queue.Empty:
            return
        limit = request["timeout"] + GRACE

        def alive(*how_far: int, limit: float = limit) -> None:
            """Say that a part of the work is done: the time for the next one begins."""
            faulthandler.dump_traceback_later(limit, exit=True)  # if nobody is left to end us
            _answer(channel, {"status": ALIVE, "how_far": how_far})

        faulthandler.dump_traceback_later(limit, exit=True)
        _answer(channel, handle(request, alive))
        faulthandler.cancel_dump_traceback_later()


def _listen(requests: queue.Queue[str], folder: str) -> None:
    for line in sys.stdin:
        requests.put(line)
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(0)  # who asked us is gone: whatever we are doing is of no use


def _answer(channel: TextIO, record: dict[str, Any]) -> None:
    channel.write(MARK + json.dumps(record) + "\n")
    channel.flush()


def handle(request: Request, alive: Alive = lambda *how_far: None) -> dict[str, Any]:
    """Do what a request asks; every error becomes an answer. ``alive`` is called after each part of the work."""
    try:
        return load_function(request["work"])(request, alive)
    except DiskFullError as error:
        return {"status": "full", "reason": str(error)}
    except UniSGError as error:
        return {"status": "failed", "reason": str(error)}
    except MemoryError:
        return {"status": "failed", "reason": "out of memory", "tired": True}
    except Exception as error:
        if isinstance(error, OSError) and error.errno == errno.ENOMEM:
            return {"status": "failed", "reason": "out of memory", "tired": True}
        return {"status": "failed", "reason": f"{type(error).__name__}: {error}".splitlines()[0], "tired": True}


def main(memory: int, folder: str) -> None:
    """Serve, and end the process."""
    try:
        serve(memory, folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    end_process(0)
