"""Ending a process in which Blender may be."""

from __future__ import annotations

import atexit
import contextlib
import os
import shutil
import sys
from pathlib import Path
from typing import NoReturn


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
