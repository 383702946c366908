"""Keep Blender's chatter out of our own output."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import tempfile
from collections.abc import Iterator


@contextlib.contextmanager
def captured_output() -> Iterator[list[str]]:
    """Catch everything that Blender and its importers print to stdout and stderr, Python's and C's alike.

    Yields a list that holds the printed lines after the block.
    """
    lines: list[str] = []
    with tempfile.TemporaryFile() as catch:
        _flush()
        kept = [os.dup(number) for number in (1, 2)]
        try:
            for number in (1, 2):
                os.dup2(catch.fileno(), number)
            yield lines
        finally:
            _flush()
            for number, saved in zip((1, 2), kept, strict=True):
                os.dup2(saved, number)
                os.close(saved)
            catch.seek(0)
            lines += catch.read().decode("utf-8", "replace").splitlines()


def _flush() -> None:
    """Empty the buffers of Python and of the C library, which would else come out later in the wrong place."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    with contextlib.suppress(OSError, AttributeError):
        library = ctypes.cdll.msvcrt if os.name == "nt" else ctypes.CDLL(None)
        library.fflush(None)
