"""How a process ends: when it is asked to, with the one that started it, and with Blender in it."""

from __future__ import annotations

import atexit
import contextlib
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

LOOK = 0.5
"""Seconds between two looks whether the parent is still there."""


def stop_when_asked() -> None:
    """Let SIGTERM and a closed terminal end the work as Ctrl-C does, so that nothing half-done is left."""
    for name in ENDS[1:]:
        number = getattr(signal, name, None)  # Windows has only some
        if number is not None and signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, signal.default_int_handler)


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


def end_with_parent() -> None:
    """From now on, end this process when the one that started it has ended, however that ended."""
    parent, number = parent_process(), os.getppid()

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
    folder = Path(blender.app.tempdir)
    if folder.name.startswith("blender_"):  # else it is the one that all programs share
        shutil.rmtree(folder, ignore_errors=True)
    os._exit(status)
