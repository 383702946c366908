"""When a scene plays: the frame that is shown, the range of frames, and their rate."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import UniSGError

DEFAULT_RATE = 24.0
RATES = (1e-3, 1e5)
"""Lowest and highest number of frames per second."""
LONGEST = 1e7
"""The latest moment in seconds, and minus the earliest one."""
FURTHEST = LONGEST * RATES[1]
"""The last frame that can be named, and minus the first one."""
WHOLE = 1e-9
"""A frame this near to a whole one, relative, is that one."""


@dataclass(frozen=True)
class FrameRange:
    """Frames; a frame is at ``frame / rate`` seconds, as the times of motion and recordings are.

    Attributes
    ----------
    frame
        The one that is shown now.
    start, end
        The first and the last one that are played; motion may go on beyond them.
    rate
        Frames per second.

    Raises
    ------
    UniSGError
        If a number is none, or is beyond :data:`RATES` or :data:`FURTHEST`, or the end comes before the start.
    """

    frame: float
    start: float
    end: float
    rate: float

    def __post_init__(self) -> None:
        if not is_rate(self.rate):
            raise UniSGError(f"{self.rate:g} frames per second are no rate: give one from {RATES[0]} to {RATES[1]:g}")
        for value in (self.frame, self.start, self.end):
            if not abs(value) <= FURTHEST:
                raise UniSGError(f"there is no frame {value:g}: they go to {FURTHEST:g}")
        if self.end < self.start:
            raise UniSGError(f"the frames end at {self.end:g}, before they begin at {self.start:g}")


def is_rate(value: float) -> bool:
    """Whether so many frames per second, or time codes, can be played."""
    return math.isfinite(value) and RATES[0] <= value <= RATES[1]


def frames_at(seconds: ArrayLike, rate: float) -> list[float]:
    """Frames at ``rate`` per second of moments in seconds (K,), without the rounding that whole ones would show."""
    frames = np.asarray(seconds, np.float64) * rate
    whole = np.round(frames)
    with np.errstate(invalid="ignore"):  # infinite ones, which nothing can be said of
        found: list[float] = np.where(np.abs(frames - whole) <= WHOLE * np.abs(whole), whole, frames).tolist()
    return found
