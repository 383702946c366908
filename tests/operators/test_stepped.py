"""Operators that work between redraws: to the end, until Esc, and into an error; the timer goes away each time."""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType, SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import pytest

bpy = pytest.importorskip("bpy")


class Work:
    """An operator as a plain object: Blender makes those of its own classes only when it runs them."""

    def __init__(self, base: ModuleType, fails_at: int = -1, fails_in_finish: bool = False) -> None:
        self.error, self.fails_at, self.fails_in_finish = base.UniSGError, fails_at, fails_in_finish
        self.closed, self.reports, self.base = False, list[tuple[set[str], str]](), base

    def __getattr__(self, name: str) -> Any:
        for kind in (self.base.SteppedOperator, self.base.Operator):
            if name in vars(kind):
                return vars(kind)[name].__get__(self)
        raise AttributeError(name)

    def report(self, level: set[str], text: str) -> None:
        self.reports.append((level, text))

    def steps(self, context: object) -> Iterator[tuple[float, str]]:
        try:
            for number in range(3):
                if number == self.fails_at:
                    raise self.error("no more")
                yield number / 3, f"Step {number}"
        finally:
            self.closed = True

    def finish(self, context: object) -> None:
        if self.fails_in_finish:
            raise self.error("not in the end")
        self.report({"INFO"}, "Done")

    def stopped(self, context: object) -> str:
        return "nothing was done"


def timer() -> SimpleNamespace:
    return SimpleNamespace(type="TIMER")


@pytest.fixture
def base(extension: ModuleType, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The module, with one step per redraw."""
    monkeypatch.setattr(extension.operators.base, "SLICE", 0.0)
    return extension.operators.base


def ended_once(context: MagicMock) -> bool:
    manager = context.window_manager
    last = context.workspace.status_text_set.call_args
    return manager.event_timer_remove.call_count == manager.progress_end.call_count == 1 and last.args == (None,)


def test_to_the_end(base: ModuleType) -> None:
    work, context = Work(base), MagicMock()
    assert work.invoke(context, timer()) == {"RUNNING_MODAL"}
    for number in range(3):
        assert work.modal(context, timer()) == {"RUNNING_MODAL"}
        assert context.workspace.status_text_set.call_args.args == (f"Step {number}   ESC: stop",)
        assert work.modal(context, SimpleNamespace(type="MOUSEMOVE")) == {"RUNNING_MODAL"}
    assert work.modal(context, timer()) == {"FINISHED"}
    assert work.reports == [({"INFO"}, "Done")]
    assert ended_once(context)


def test_escape_stops_it(base: ModuleType) -> None:
    work, context = Work(base), MagicMock()
    work.invoke(context, timer())
    work.modal(context, timer())
    assert work.modal(context, SimpleNamespace(type="ESC")) == {"CANCELLED"}
    assert work.closed
    assert work.reports == [({"INFO"}, "Stopped; nothing was done")]
    assert ended_once(context)


@pytest.mark.parametrize("options", [{"fails_at": 1}, {"fails_in_finish": True}])
def test_an_error_ends_it_with_a_report(base: ModuleType, options: dict[str, Any]) -> None:
    work, context = Work(base, **options), MagicMock()
    work.invoke(context, timer())
    found = {"RUNNING_MODAL"}
    while found == {"RUNNING_MODAL"}:
        found = work.modal(context, timer())
    assert found == {"CANCELLED"}
    assert [level for level, _ in work.reports] == [{"ERROR"}]
    assert ended_once(context)


def test_a_script_gets_all_of_it_at_once(base: ModuleType) -> None:
    work = Work(base)
    assert work.execute(MagicMock()) == {"FINISHED"}
    assert work.closed
    assert Work(base, fails_at=0).execute(MagicMock()) == {"CANCELLED"}
