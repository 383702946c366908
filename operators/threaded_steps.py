"""Work in a thread as the steps of an operator: the window is drawn and can be used meanwhile."""

from __future__ import annotations

import atexit
import threading
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import TypeVar

from ..unisg_blender.errors import UniSGError

LOOK, PATIENCE = 0.02, 10.0
"""Seconds that one waits before one looks again whether it is done, and that the end of Blender waits for it."""

Result = TypeVar("Result")


@dataclass
class Share:
    """How much of some work is ``done``, 0 to 1, in words, and whether it is to stop; shared with its thread."""

    done: float
    text: str
    stopped: bool = False

    def tell(self, done: float, text: str) -> None:
        """Say how far it is; ends the work where it is to stop."""
        self.done, self.text = done, text
        if self.stopped:
            raise UniSGError("stopped")


def in_thread(work: Callable[[Share], Result], text: str) -> Generator[tuple[float, str], None, Result]:
    """Steps that end with what some ``work`` returns, or raise what it raises; nothing of Blender's is touched there.

    Closed before its end, the work stops when it next tells how far it is.
    """
    share, results = Share(0.0, text), list[Result | Exception]()

    def run() -> None:
        """What the thread does."""
        try:
            results.append(work(share))
        except Exception as error:  # raised where it is waited for
            results.append(error)

    thread = threading.Thread(target=run, name="UniSG", daemon=True)
    thread.start()
    atexit.register(thread.join, PATIENCE)  # Python must not be taken down under it
    try:
        while thread.is_alive():
            thread.join(LOOK)
            yield share.done, share.text
    finally:
        share.stopped = True
        atexit.unregister(thread.join)
    (found,) = results
    if isinstance(found, Exception):
        raise found
    return found
