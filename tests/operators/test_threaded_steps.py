"""Work in a thread: its steps, its result, its failure, and that it stops when nobody waits for it any more."""

from __future__ import annotations

import threading
import time
from collections.abc import Generator
from types import ModuleType

import pytest

pytest.importorskip("bpy")


@pytest.fixture(scope="module")
def module(extension: ModuleType) -> ModuleType:
    return extension.operators.threaded_steps


def outcome(steps: Generator[object, None, int]) -> int:
    """What steps end with."""
    while True:
        try:
            next(steps)
        except StopIteration as stop:
            return int(stop.value)


def test_it_tells_how_far_it_is_and_ends_with_the_result(module: ModuleType) -> None:
    go = threading.Event()

    def work(share: object) -> int:
        share.tell(0.5, "half")  # type: ignore[attr-defined]
        go.wait(10)
        return 7

    steps, seen = module.in_thread(work, "begin"), [(0.0, "")]
    while seen[-1] != (0.5, "half"):
        seen.append(next(steps))
    go.set()
    assert outcome(steps) == 7


def test_what_it_raises_is_raised_where_it_is_waited_for(module: ModuleType, extension: ModuleType) -> None:
    def work(share: object) -> None:
        raise extension.operators.base.UniSGError("no model")

    with pytest.raises(extension.operators.base.UniSGError, match="no model"):
        list(module.in_thread(work, "begin"))


def test_closed_it_stops_at_its_next_step(module: ModuleType) -> None:
    count, ended = [0], threading.Event()

    def work(share: object) -> None:
        try:
            for number in range(10_000):
                count[0] = number
                share.tell(0.0, "on")  # type: ignore[attr-defined]
                time.sleep(0.001)
        finally:
            ended.set()

    steps = module.in_thread(work, "begin")
    next(steps)
    steps.close()
    assert ended.wait(10)
    assert count[0] < 9_999
