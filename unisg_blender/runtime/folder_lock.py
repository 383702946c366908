"""One writer at a time in a folder."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import UniSGError

NAME = ".lock"


@contextmanager
def folder_lock(folder: Path) -> Iterator[None]:
    """Hold the folder for this process; the system gives it free when the process ends, however it ends.

    Raises
    ------
    UniSGError
        If another process holds it, or the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle = os.open(folder / NAME, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise UniSGError(f"cannot write to {folder}: {error.strerror}; choose another folder") from None
    try:
        _lock(handle)
    except OSError:
        os.close(handle)
        raise UniSGError(f"another export is writing to {folder}: wait for it, or choose another folder") from None
    try:
        yield
    finally:
        os.close(handle)


def _lock(handle: int) -> None:
    """Take an exclusive lock or raise OSError."""
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
