"""Quick answers to "is it turned by at most so much?": no angle is computed where the answer is plain.

The trace of a relative rotation by the angle a is 1 + 2 cos a. For matrices whose
columns are nearly at right angles it follows from a few products; where it leaves no
doubt, nothing else is needed. :mod:`..behaviour.fulfilment.deviation` computes the angle itself.
"""

from __future__ import annotations

import numpy as np

from .affine_rows import Array, column_products, determinant
from .arrays import Bools

_SKEW = 1e-13
"""By this much less than 1 may the volume of columns of length 1 be: they are askew by at most 5e-7."""

_MARGIN = 1e-5
"""Of the trace; far more than what so little skew, or rounding, can change."""


def least_trace(angle: Array) -> Array:
    """The trace (K,) of rotations by ``angle`` radians, at most pi; what is turned less has more."""
    return 1.0 + 2.0 * np.cos(np.minimum(angle, np.pi))


def compose_turns(first: Array, second: Array) -> Array:
    """Products (3, 3, K) of matrices (3, 3, K)."""
    result: Array = first[:, :1] * second[:1]
    result += first[:, 1:2] * second[1:2]
    result += first[:, 2:] * second[2:]
    return result


def plainly_turned(first: Array, second: Array, trace: Array) -> tuple[Bools, Bools]:
    """Where the turn between matrices (3, 3, K) is plainly below, and where plainly above the angle of ``trace``.

    Both bool (K,); neither is true where the limit is too near, or a matrix is sheared,
    flat or no number.
    """
    with np.errstate(all="ignore"):
        size = column_products(first, first)
        size *= column_products(second, second)
        np.sqrt(size, out=size)
        along = column_products(first, second)
        along /= size
        found = along[0] + along[1] + along[2]
        volume = determinant(first) * determinant(second)
        volume /= size[0] * size[1] * size[2]
        found *= np.sign(volume)  # a mirrored one is turned as -A is, see Blender's decompose
        straight = np.abs(volume) >= 1.0 - _SKEW
    return straight & (found >= trace + _MARGIN), straight & (found <= trace - _MARGIN)
