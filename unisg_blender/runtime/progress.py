"""A progress bar on stderr: tqdm's, for work whose size may become known on the way."""

from __future__ import annotations

import sys
from typing import TextIO

from tqdm import tqdm

EVERY = 0.2
EVERY_IN_LOG = 10.0


class Progress:
    """Shows how far a batch is: bar, count, rate, time left, failures.

    On a terminal the line is rewritten; in a log a line is printed now and then.
    """

    def __init__(self, total: int, unit: str, quiet: bool = False, stream: TextIO | None = None) -> None:
        stream = sys.stderr if stream is None else stream
        every = EVERY if stream.isatty() else EVERY_IN_LOG
        delay = 0 if total else every  # a refusal that comes before anything is known leaves no bar behind
        self._bar = tqdm(
            total=total or None, unit=f" {unit}", disable=quiet, file=stream, mininterval=every, delay=delay
        )

    def start(self, total: int) -> None:
        """Say how much there is to do, once that is known."""
        self._bar.total, self._bar.delay = total, 0
        self._bar.refresh()

    def update(self, done: int, failed: int = 0) -> None:
        """Show that ``done`` of the total are finished, ``failed`` of them in vain."""
        if failed:
            self._bar.set_postfix(failed=failed, refresh=False)
        self._bar.update(done - self._bar.n)

    def say(self, text: str) -> None:
        """Show words behind the count, from the next update on."""
        self._bar.set_postfix_str(text, refresh=False)

    def write(self, text: str) -> None:
        """Print a line above the bar."""
        if not self._bar.disable:
            self._bar.write(text, file=self._bar.fp)

    def close(self) -> None:
        """End the bar's line."""
        self._bar.close()
