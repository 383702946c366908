"""Keep what Blender, USD and their importers print out of our own output."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from typing import Any

_kept: list[tuple[list[int], Any]] = []  # true stdout and stderr, and Python's stderr, while they are caught


@contextlib.contextmanager
def captured_output() -> Iterator[list[str]]:
    """Catch everything that Blender, USD and importers print to stdout and stderr, Python's and C's alike.

    Yields a list that holds the printed lines after the block.
    """
    lines: list[str] = []
    with tempfile.TemporaryFile() as catch:
        _flush()
        kept = [os.dup(number) for number in (1, 2)]
        _kept.append((kept, sys.stderr))
        try:
            for number in (1, 2):
                os.dup2(catch.fileno(), number)
            with _instead_of_python_streams(catch.fileno()):
                yield lines
        finally:
            _flush()
            _kept.pop()
            for number, saved in zip((1, 2), kept, strict=True):
                os.dup2(saved, number)
                os.close(saved)
            catch.seek(0)
            lines += catch.read().decode("utf-8", "replace").splitlines()


@contextlib.contextmanager
def _instead_of_python_streams(number: int) -> Iterator[None]:
    """Let Python print to a file, for in a notebook its streams are no files: Blender says there what it has saved."""
    words = open(number, "w", buffering=1, encoding="utf-8", errors="replace", closefd=False)  # noqa: SIM115
    with words, contextlib.redirect_stdout(words), contextlib.redirect_stderr(words):
        yield


def heard(tell: Callable[[int, int], None]) -> Callable[[int, int], None]:
    """The same function of progress, whose words on stderr are not caught with all the rest."""

    def told(done: int, total: int) -> None:
        """Tell the progress on the real standard error, not the caught one."""
        if not _kept:
            return tell(done, total)
        _flush()
        (_, true), stream = _kept[-1]
        catch = os.dup(2)
        os.dup2(true, 2)
        try:
            with contextlib.redirect_stderr(stream):
                tell(done, total)
                _flush()
        finally:
            os.dup2(catch, 2)
            os.close(catch)

    return told


def _flush() -> None:
    """Empty the buffers of Python and of the C library, which would else come out later in the wrong place."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    with contextlib.suppress(OSError, AttributeError):
        library = ctypes.cdll.msvcrt if os.name == "nt" else ctypes.CDLL(None)
        library.fflush(None)
