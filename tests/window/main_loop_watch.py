"""Runs inside Blender: how long its main loop stands still, and for how much of that our own code runs.

A timer that is due all the time notes the gaps between its calls; our own calls in the main thread are timed by
``sys.monitoring``, which Python has from 3.12 on, and code of others is left out of it at once.
"""

from __future__ import annotations

import sys
import threading
import time
from types import CodeType
from typing import Any

import bpy

PACKAGE = "unisg_blender"
TOOL = 4
SHOWN = 5
"""Of the longest ones so many are told."""


class MainLoopWatch:
    """Watches until :meth:`end`."""

    def __init__(self) -> None:
        self.gaps: list[float] = []
        self.calls: list[tuple[float, float, str]] = []
        self._depth, self._began, self._work = 0, 0.0, 0.0
        self._start = self._last = time.perf_counter()
        self._timer = self._tick  # Blender knows a timer by the very object
        bpy.app.timers.register(self._timer)
        if hasattr(sys, "monitoring"):
            self._listen()

    def _tick(self) -> float:
        now = time.perf_counter()
        self.gaps.append(now - self._last)
        self._last = now
        return 0.001

    def _listen(self) -> None:
        monitor = sys.monitoring
        monitor.use_tool_id(TOOL, "main loop")
        kinds = monitor.events
        into = (kinds.PY_START, kinds.PY_RESUME, kinds.PY_THROW)
        out = (kinds.PY_RETURN, kinds.PY_YIELD, kinds.PY_UNWIND)
        for kind in into:
            monitor.register_callback(TOOL, kind, self._enters if kind != kinds.PY_THROW else self._thrown_into)
        for kind in out:
            monitor.register_callback(TOOL, kind, self._leaves if kind != kinds.PY_UNWIND else self._thrown_out)
        monitor.set_events(TOOL, sum(into + out))

    def _enters(self, code: CodeType, *_: Any) -> object:
        if PACKAGE not in code.co_filename:
            return sys.monitoring.DISABLE
        return self._thrown_into(code)

    def _leaves(self, code: CodeType, *_: Any) -> object:
        if PACKAGE not in code.co_filename:
            return sys.monitoring.DISABLE
        return self._thrown_out(code)

    def _thrown_into(self, code: CodeType, *_: Any) -> None:
        if PACKAGE in code.co_filename and threading.current_thread() is threading.main_thread():
            if self._depth == 0:
                self._began, self._work = time.perf_counter(), time.thread_time()
            self._depth += 1

    def _thrown_out(self, code: CodeType, *_: Any) -> None:
        if self._depth and PACKAGE in code.co_filename and threading.current_thread() is threading.main_thread():
            self._depth -= 1
            if self._depth == 0:
                place = f"{code.co_filename.rpartition(PACKAGE)[2].strip('/')}: {code.co_qualname}"
                self.calls.append((time.perf_counter() - self._began, time.thread_time() - self._work, place))

    def end(self) -> dict[str, Any]:
        """Stop, and tell: seconds in all, how often the main loop came round, longest gaps and own calls in ms.

        ``ours_work_ms`` is the processor time of the main thread alone: what is more waits for others.
        """
        bpy.app.timers.unregister(self._timer)
        if hasattr(sys, "monitoring"):
            sys.monitoring.set_events(TOOL, 0)
            sys.monitoring.free_tool_id(TOOL)
        ours = [(round(1e3 * spent, 1), round(1e3 * work, 1), place) for spent, work, place in sorted(self.calls)[::-1]]
        return {
            "seconds": round(time.perf_counter() - self._start, 2),
            "rounds": len(self.gaps),
            "gaps_ms": [round(1e3 * gap, 1) for gap in sorted(self.gaps, reverse=True)[:SHOWN]],
            "ours_ms": [spent for spent, *_ in ours[:SHOWN]],
            "ours_work_ms": [work for _, work, _ in ours[:SHOWN]],
            "ours": [place for *_, place in ours[:SHOWN]],
        }


bpy.app.driver_namespace["main_loop_watch"] = MainLoopWatch()
