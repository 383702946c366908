"""Numbers and names on the command line: what argparse takes for an option, and between which limits."""

from __future__ import annotations

from argparse import ArgumentTypeError
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeVar

N = TypeVar("N", int, float)

LARGEST_SEED = 2**32 - 1
"""What every generator of random numbers takes, torch's and scikit-learn's too."""

MOST_PROCESSES = 1024
LONGEST_SHOWN = 40


def whole(least: int, most: int) -> Callable[[str], int]:
    """A whole number from ``least`` to ``most``."""
    return partial(_within, int, "a whole number", least, most)


def number(least: float, most: float) -> Callable[[str], float]:
    """A finite number from ``least`` to ``most``."""
    return partial(_within, float, "a number", least, most)


def named(text: str) -> str:
    """What names a file, a folder or several: anything that is not empty, as a variable that was not set is."""
    if not text.strip():
        raise ArgumentTypeError("must be the name of a file or folder, not ''")
    return text


def _path(text: str) -> Path:
    return Path(named(text))


def _within(convert: Callable[[str], N], kind: str, least: float, most: float, text: str) -> N:
    try:
        value = convert(text)
    except ValueError:
        raise _refused(kind, least, most, text) from None
    if not least <= value <= most:  # false for nan, too
        raise _refused(kind, least, most, text)
    return value


def _refused(kind: str, least: float, most: float, text: str) -> ArgumentTypeError:
    shown = text if len(text) <= LONGEST_SHOWN else text[:LONGEST_SHOWN] + " ..."
    return ArgumentTypeError(f"must be {kind} from {least:.15g} to {most:.15g}, not {shown!r}")


SEED = whole(0, LARGEST_SEED)
PROCESSES = whole(1, MOST_PROCESSES)
PATH = _path
