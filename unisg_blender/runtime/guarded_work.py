"""The command line's work in a process of its own, so that a file over which a library crashes or hangs costs one line.

Blender and USD do, on damaged files; nothing in Python can catch that. The process
that was started only waits: it divides itself before anything large is loaded, which
takes a millisecond. Windows cannot divide a process: there the work is done unguarded.
"""

from __future__ import annotations

import contextlib
import faulthandler
import mmap
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NoReturn

from ..errors import UNUSABLE_INPUT, UniSGError, one_line
from .file_endings import USD, is_of
from .process_end import ENDS, SIGNALLED, blender_folder, end_with_parent, ended_by, remove_temporary

PATIENCE = 10.0
"""Seconds that a file may take to be opened, and each following step of its reading."""

A_MEGABYTE = 1.0
"""Seconds more for each megabyte of it."""

EVALUATED = 600.0
"""Seconds that Blender may take to evaluate a scene that it has opened."""

VARIABLE = "UNISG_READING_SECONDS"
"""Environment variable that makes both limits longer."""

ANSWER = 3
"""Seconds that a process within a library has to answer a signal to end."""

SIZE = 32768
"""Bytes for what is read."""


class _Watch:
    """What a guarded process keeps of its guard."""

    def __init__(self, note: mmap.mmap) -> None:
        self.note = note  # what is read and within how many seconds: seen by the process that waits
        self.path = ""  # the file that is read
        self.limit = 0.0  # seconds for a step of its reading
        self.set_at = 0.0  # when the clock was set last
        self.nowhere = open(os.devnull, "wb")  # noqa: SIM115 (as long as this process)

    def set_clock(self, seconds: float) -> None:
        """End this process in so many seconds, whatever it does then."""
        self.set_at = time.monotonic()
        words = (f"{seconds:.0f}", blender_folder(), self.path)
        self.note[:] = os.fsencode("\0".join(words))[:SIZE].ljust(SIZE, b"\0")
        faulthandler.dump_traceback_later(seconds, exit=True, file=self.nowhere)

    def stop_clock(self) -> None:
        """Nothing is read any more."""
        faulthandler.cancel_dump_traceback_later()
        self.path = ""
        self.note[:] = bytes(SIZE)


_watch: _Watch | None = None


def run_guarded(work: Callable[[], NoReturn], name: str) -> NoReturn:
    """Do work that ends its process in a process of its own, and end this one as that ended.

    Signals to end are passed on. If the work crashed, or did not get beyond a file within
    the time for it, one line on stderr says so.

    Parameters
    ----------
    work
        What to do.
    name
        What the line begins with, such as "unisg convert".
    """
    global _watch
    if not hasattr(os, "fork"):
        work()
    note, parent = mmap.mmap(-1, SIZE), os.getpid()
    child = os.fork()
    if child == 0:
        _watch = _Watch(note)
        end_with_parent(parent)
        work()
    stopped = _pass_signals_on(child, note)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    told = _told(note)
    if code >= 0 and not told:
        sys.exit(code)
    remove_temporary(child, told[1] if told else "")
    status, line = (SIGNALLED + signal.SIGINT, "stopped") if stopped else _fate(code, told)
    print(f"{name}: {line}", file=sys.stderr)
    sys.exit(status)


@contextlib.contextmanager
def reading(path: Path) -> Iterator[None]:
    """Let the guard of this process, if it has one, know what is read, and end it if that takes too long.

    Raises
    ------
    UniSGError
        If :data:`VARIABLE` is no number of seconds.
    """
    watch = _watch
    if watch is None:
        yield
        return
    watch.path, watch.limit = str(path), max(_patience(), _time_for(path))
    try:
        watch.set_clock(watch.limit)
        yield
    finally:
        watch.stop_clock()


def still_reading(seconds: float = 0.0) -> None:
    """Say that the reading goes on, which gives it its time anew, or so many seconds if that is more."""
    if _watch is not None and _watch.path and (seconds or time.monotonic() > _watch.set_at + 1.0):
        _watch.set_clock(max(seconds, _watch.limit))


def reading_part(path: Path) -> None:
    """Say that a file is read now of which the one that is read is made: it has its own time, by its own size."""
    still_reading(_time_for(path))


def _time_for(path: Path) -> float:
    return PATIENCE + A_MEGABYTE * (path.stat().st_size if path.is_file() else 0) / 1e6


def _patience() -> float:
    text = os.environ.get(VARIABLE, "0")
    try:
        seconds = float(text)
    except ValueError:
        seconds = -1.0
    if not 0 <= seconds <= 1e6:
        raise UniSGError(f"the environment variable {VARIABLE} is {text[:50]!r}: it takes seconds, from 0 to 1000000")
    return seconds


def _told(note: mmap.mmap) -> list[str]:
    """The seconds within which something is to come of a file, Blender's folder, and the file; [] if none is read."""
    text = os.fsdecode(note[:].rstrip(b"\0"))
    return text.split("\0") if text else []


def _pass_signals_on(child: int, note: mmap.mmap) -> list[int]:
    """Pass signals to end on to the work, and kill it if it stays within a library; a list that gets their numbers."""
    asked: list[int] = []

    def pass_on(number: int, frame: object) -> None:
        """Ask the work to end."""
        asked.append(number)
        with contextlib.suppress(ProcessLookupError):
            os.kill(child, number)
        if _told(note):
            signal.alarm(ANSWER)

    def insist(number: int, frame: object) -> None:
        """Kill it where it stays within a library."""
        if _told(note):
            with contextlib.suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)

    signal.signal(signal.SIGALRM, insist)
    for name in ENDS:
        if signal.getsignal(number := getattr(signal, name)) != signal.SIG_IGN:
            signal.signal(number, pass_on)
    return asked


def _fate(code: int, told: list[str]) -> tuple[int, str]:
    """The exit status for how the work ended, and the line that says it."""
    if not told:
        return SIGNALLED - code, f"the process {ended_by(code)}"
    seconds, _, path = told
    if code < 0:
        why = f"{'USD' if is_of(Path(path), USD) else 'Blender'} {ended_by(code)} while reading it; is it damaged?"
    else:
        why = f"nothing came of it within {seconds} s; is it damaged? If it only takes long, set {VARIABLE}=600"
    return UNUSABLE_INPUT, f"cannot read {one_line(path)}: {why}"
