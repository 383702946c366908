"""Between which values each group of some numbers, or of some intervals, lies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .arrays import Floats, Ints


def grouped_ends(
    group: Ints, count: int, low: NDArray[np.generic], high: NDArray[np.generic] | None = None
) -> tuple[Floats, Floats]:
    """The least of ``low`` (N, ...) and the greatest of ``high`` (``low`` itself without one) in each of the groups.

    ``group`` (N,) numbers them from 0; both results are (``count``, ...), inf and -inf for a group of nothing.
    """
    shape = (count, *low.shape[1:])
    least, greatest = np.full(shape, np.inf), np.full(shape, -np.inf)
    np.minimum.at(least, group, low)
    np.maximum.at(greatest, group, low if high is None else high)
    return least, greatest
