"""How a process ends: when it is asked to, with the one that started it, and with Blender in it."""

from __future__ import annotations

import atexit
import contextlib
import math
import os
import shutil
import signal
import sys
import threading
import time
from collections.abc import Iterator
from multiprocessing import parent_process
from pathlib import Path
from typing import NoReturn

ENDS = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals that ask a process to end."""

SIGNALLED = 128
"""Exit status of what a signal ended is this and its number."""

LOOK = 0.5
"""Seconds between two looks whether the parent is still there."""

TWICE = 1.0
"""Seconds within which signals to end count as one: a terminal sends them to a process and to what started it."""

_asked = -math.inf  # when this process was asked to end last


def stop_when_asked() -> None:
    """Let SIGTERM and a closed terminal end the work as Ctrl-C does, so that nothing half-done is left."""
    for name in ENDS:
        number = getattr(signal, name, None)  # Windows has only some
        if number is not None and signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, _stop)


def _stop(number: int, frame: object) -> None:
    """Raise KeyboardInterrupt, once for signals that come together."""
    global _asked
    before, _asked = _asked, time.monotonic()
    if _asked - before > TWICE:
        raise KeyboardInterrupt


@contextlib.contextmanager
def signals_kept() -> Iterator[None]:
    """Answer signals to end only after the block, for libraries that break when Python is interrupted inside them.

    Blender does while it is loaded: it swallows the exception, or crashes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    asked: list[int] = []
    before = {
        number: signal.signal(number, lambda number, frame: asked.append(number))
        for name in ENDS
        if callable(signal.getsignal(number := getattr(signal, name, signal.SIGINT)))
    }
    try:
        yield
    finally:
        for number, answer in before.items():
            signal.signal(number, answer)
    for number in asked[:1]:
        signal.raise_signal(number)


def end_with_parent(number: int | None = None) -> None:
    """From now on, end this process when the one that started it (its ``number``) has ended, however that ended."""
    parent, number = parent_process(), os.getppid() if number is None else number

    def wait() -> None:
        """Wait for the parent's end, for ever if need be."""
        if parent is not None:
            parent.join()
        while parent is None and os.getppid() == number:
            time.sleep(LOOK)
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


def end_process(status: int) -> NoReturn:
    """End this process with an exit status, without Blender's own cleaning up where Blender was imported.

    That may last for ever: after a driver that Blender evaluated with Python, or after an undo, it waits
    there for what ended with Python.
    """
    blender = sys.modules.get("bpy")
    if blender is None:
        sys.exit(status)
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError):  # who reads it (head, less) has gone
            stream.flush()
    remove_temporary(os.getpid(), blender_folder())
    os._exit(status)


def blender_folder() -> str:
    """Blender's folder for temporary files of this process; "" where there is no Blender."""
    blender = sys.modules.get("bpy")
    return getattr(getattr(blender, "app", None), "tempdir", "")


def remove_temporary(process: int, folder: str) -> None:
    """Remove what Blender and USD have left of a process: a folder, and a report of how it crashed."""
    if Path(folder).name.startswith("blender_"):  # else it is the one that all programs share
        shutil.rmtree(folder, ignore_errors=True)
    for report in Path(os.environ.get("TMPDIR", "/var/tmp")).glob(f"st_python*.{process}"):
        with contextlib.suppress(OSError):
            report.unlink()


def ended_by(code: int) -> str:
    """How a process ended that Python's ``subprocess`` gives a negative code for, in words."""
    hint = " (out of memory?)" if -code == getattr(signal, "SIGKILL", 9) else ""
    return f"crashed with {signal.Signals(-code).name}{hint}"
