"""Work that is done step by step, so that who asked for it can show it or stop it."""

from __future__ import annotations

from collections.abc import Callable, Generator
from functools import wraps
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
Step = TypeVar("Step")
Result = TypeVar("Result")


def drain(steps: Generator[Step, None, Result], show: Callable[[Step], Any] = lambda _: None) -> Result:
    """Do all steps, showing each, and return what they result in."""
    while True:
        try:
            step = next(steps)
        except StopIteration as end:
            return end.value
        show(step)


def at_once(steps: Callable[P, Generator[Any, None, Result]]) -> Callable[P, Result]:
    """A function of steps as one that does all of them, with the same arguments."""

    @wraps(steps)
    def run(*args: P.args, **kwargs: P.kwargs) -> Result:
        return drain(steps(*args, **kwargs))

    return run
