"""One writer at a time in a folder."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from ..errors import UniSGError

NAME = ".lock"
"""File that is held where the system cannot hold a folder: on Windows and on network drives."""


@contextlib.contextmanager
def folder_lock(folder: Path) -> Iterator[None]:
    """Hold a folder for this process; the system gives it free when the process ends, however it ends.

    Raises
    ------
    UniSGError
        If another process holds it, or the folder cannot be written.
    """
    try:
        if not os.access(folder, os.W_OK):
            raise PermissionError(0, "it is read-only")
        handle = _hold(folder)
    except BlockingIOError:
        raise UniSGError(f"another export is writing to {folder}: wait for it, or choose another folder") from None
    except OSError as error:
        raise UniSGError(f"cannot write to {folder}: {error.strerror}; choose another folder") from None
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            (folder / NAME).unlink()
        os.close(handle)


def _hold(folder: Path) -> int:
    """What is held, to be closed; BlockingIOError if another process holds it."""
    if sys.platform == "win32":
        import msvcrt

        handle = os.open(folder / NAME, os.O_RDWR | os.O_CREAT | os.O_TEMPORARY)  # gone when it is closed
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError:
            os.close(handle)
            raise BlockingIOError from None
        return handle
    try:
        return _flocked(folder, os.O_RDONLY)
    except BlockingIOError:
        raise
    except OSError:  # NFS locks only what is open for writing, and that no folder is
        return _flocked(folder / NAME, os.O_RDWR | os.O_CREAT)


def _flocked(path: Path, mode: int) -> int:
    import fcntl

    handle = os.open(path, mode, 0o644)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if not os.fstat(handle).st_nlink:  # who held it has just removed it
            raise BlockingIOError
    except OSError:
        os.close(handle)
        raise
    return handle
