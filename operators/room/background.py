"""Work on arrays in a thread, so that the window can be used meanwhile; no Blender data is touched there."""

from __future__ import annotations

import atexit
import threading
from collections.abc import Callable
from typing import Generic, TypeVar

import bpy

from ...unisg_blender.errors import UniSGError
from ..base import redraw_views
from ..window_wording import in_window

POLL, PATIENCE = 0.1, 10.0
"""Seconds between two looks whether work is done, and that the end of Blender waits for it."""

SOON = 0.1
"""Seconds until what was looked at is looked at anew."""

Result = TypeVar("Result")


class Background(Generic[Result]):
    """One piece of work at a time; what comes of it is taken in the main thread."""

    def __init__(self) -> None:
        self._timer: Callable[[], float | None] | None = None
        self._soon: Callable[[], float | None] | None = None

    @property
    def busy(self) -> bool:
        """Whether it is at work."""
        return self._timer is not None

    def start(
        self, work: Callable[[], Result], done: Callable[[Result], object], failed: Callable[[str], object]
    ) -> None:
        """Begin some ``work``; what it returns, or what a user has to mend, is given to ``done`` or ``failed``."""
        results: list[Result | Exception] = []

        def run() -> None:
            """What the thread does."""
            try:
                results.append(work())
            except Exception as error:  # told where it can be: in the main thread
                results.append(error)

        thread = threading.Thread(target=run, name="UniSG", daemon=True)

        def take() -> float | None:
            """Look whether it is done."""
            if thread.is_alive():
                return POLL
            self._timer = None
            atexit.unregister(thread.join)
            redraw_views(bpy.context)
            for found in results:
                if isinstance(found, UniSGError | MemoryError):
                    failed(in_window(str(found)) or "there is not enough memory")
                elif isinstance(found, Exception):
                    failed("it failed: the system console says why")
                    raise found
                else:
                    done(found)
            return None

        self._timer = take
        thread.start()
        atexit.register(thread.join, PATIENCE)  # Python must not be taken down under it
        bpy.app.timers.register(take, first_interval=POLL)

    def start_soon(
        self, name: str, start: Callable[[bpy.types.Scene], object], failed: Callable[[str, str], None]
    ) -> None:
        """Have work on a scene started when Blender has finished what it does, and what goes on here has ended.

        The scene is named: a timer does not know in which window a user is. If it is gone by then, nothing is
        started, and nothing is to be said of it: ``failed("", "")``. Else that gets its name and what to mend.
        """

        def begin() -> float | None:
            """Start it, or wait."""
            if self.busy:
                return SOON
            self._soon = None
            scene = bpy.data.scenes.get(name)
            if scene is None:
                failed("", "")
                return None
            try:
                start(scene)
            except UniSGError as error:
                failed(name, in_window(str(error)))
            return None

        if self._soon is None:
            self._soon = begin
            bpy.app.timers.register(begin, first_interval=SOON)

    def end(self) -> None:
        """Forget what is going on and what is to come, without waiting: nothing is done with what comes of it."""
        for timer in (self._timer, self._soon):
            if timer is not None and bpy.app.timers.is_registered(timer):
                bpy.app.timers.unregister(timer)
        self._timer = self._soon = None
