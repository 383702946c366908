"""Between which coordinates the corners of many small shapes lie."""

from __future__ import annotations

import numpy as np

from .arrays import Bools, Floats


def corner_ends(shapes: Floats) -> tuple[Floats, Floats]:
    """Least and greatest coordinates (M, K) of M shapes of some corners each, (M, C, K).

    Corner by corner: along an axis of three numpy takes ten times as long.
    """
    low = high = shapes[:, 0]
    for corner in range(1, shapes.shape[1]):
        low, high = np.minimum(low, shapes[:, corner]), np.maximum(high, shapes[:, corner])
    return low, high


def meeting_ends(low: Floats, high: Floats, other_low: Floats, other_high: Floats) -> Bools:
    """Which of some boxes (M, 3) meet another one (3,), or one each (M, 3)."""
    found = low <= other_high
    found &= high >= other_low
    return found[:, 0] & found[:, 1] & found[:, 2]
