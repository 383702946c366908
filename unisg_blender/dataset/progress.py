"""A progress bar on stderr."""

from __future__ import annotations

import sys
import time
from typing import TextIO

WIDTH = 30
EVERY = 0.2
EVERY_IN_LOG = 10.0


class Progress:
    """Shows how far a batch is: bar, count, rate, time left, failures.

    On a terminal the line is rewritten; in a log a line is printed now and then.
    """

    def __init__(self, total: int, unit: str, quiet: bool = False, stream: TextIO | None = None) -> None:
        self.total = total
        self.unit = unit
        self.stream = sys.stderr if stream is None else stream
        self.quiet = quiet
        self.failed = 0
        self._start = self._shown = time.monotonic()
        self._terminal = self.stream.isatty()

    def start(self, total: int) -> None:
        """Begin, now that the total is known."""
        self.total = total
        self._start = self._shown = time.monotonic()

    def update(self, done: int, failed: int = 0) -> None:
        """Show that ``done`` of the total are finished, ``failed`` of them in vain."""
        self.failed = failed
        now = time.monotonic()
        wait = EVERY if self._terminal else EVERY_IN_LOG
        if self.quiet or (now - self._shown < wait and done < self.total):
            return
        self._shown = now
        line = self.line(done, now - self._start)
        print(f"\r\033[K{line}" if self._terminal else line, end="" if self._terminal else "\n", file=self.stream)
        self.stream.flush()

    def line(self, done: int, seconds: float) -> str:
        """The line to show."""
        filled = WIDTH * done // max(self.total, 1)
        rate = done / seconds if seconds > 0 else 0.0
        left = f", {_duration((self.total - done) / rate)} left" if done and done < self.total else ""
        failures = f", {self.failed} failed" if self.failed else ""
        bar = "#" * filled + "." * (WIDTH - filled)
        return f"[{bar}] {done}/{self.total} {self.unit}, {rate:.1f} {self.unit}/s{left}{failures}"

    def write(self, text: str) -> None:
        """Print a line above the bar."""
        if not self.quiet:
            print(f"\r\033[K{text}" if self._terminal else text, file=self.stream)

    def close(self) -> None:
        """End the bar's line."""
        if self._terminal and not self.quiet:
            print(file=self.stream)


def _duration(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min" if hours else f"{minutes} min {seconds:02} s" if minutes else f"{seconds} s"
