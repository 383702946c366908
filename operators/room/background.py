"""Work on arrays in a thread, so that the window can be used meanwhile; no Blender data is touched there."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

import bpy

from ...unisg_blender.errors import UniSGError
from ..base import redraw_views

POLL, PATIENCE = 0.1, 10.0
"""Seconds between two looks whether work is done, and that the end of the extension waits for it."""

Result = TypeVar("Result")


class Background(Generic[Result]):
    """One piece of work at a time; what comes of it is taken in the main thread."""

    def __init__(self) -> None:
        self._thread: threading.Thread | None = None
        self._found: Result | Exception | None = None
        self._timer: Callable[[], float | None] | None = None

    @property
    def busy(self) -> bool:
        """Whether it is at work."""
        return self._thread is not None

    def start(self, work: Callable[[], Result], done: Callable[[Result], None], failed: Callable[[str], None]) -> None:
        """Begin some ``work``; what it returns, or what a user has to mend, is given to ``done`` or ``failed``."""

        def run() -> None:
            """What the thread does."""
            try:
                self._found = work()
            except Exception as error:  # told where it can be: in the main thread
                self._found = error

        def take() -> float | None:
            """Look whether it is done."""
            if self._thread is not None and self._thread.is_alive():
                return POLL
            found, self._thread, self._found = self._found, None, None
            redraw_views(bpy.context)
            if isinstance(found, UniSGError | MemoryError):
                failed(str(found) or "there is not enough memory")
            elif isinstance(found, Exception):
                failed("it failed: the system console says why")
                raise found
            elif found is not None:
                done(found)
            return None

        self._timer, self._thread = take, threading.Thread(target=run, name="UniSG", daemon=True)
        self._thread.start()
        bpy.app.timers.register(take, first_interval=POLL)

    def end(self) -> None:
        """Wait for what is going on, since Blender may end now, and forget it."""
        if self._timer is not None and bpy.app.timers.is_registered(self._timer):
            bpy.app.timers.unregister(self._timer)
        if self._thread is not None:
            self._thread.join(PATIENCE)
        self._thread, self._found, self._timer = None, None, None
