"""The ways between two poses that different forms take: what the form microscope draws."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .forms import FORMS
from .motion import sclerp

Floats = NDArray[np.float64]

PATH_NAMES = ("matrix", "quaternion", "quaternion, other sign", "motor")


def compare_paths(first: Floats, last: Floats, count: int) -> dict[str, Floats]:
    """Poses between two affine poses, interpolated in each way.

    Parameters
    ----------
    first, last
        Shape (4, 4).
    count
        Number of poses on each path, the ends included.

    Returns
    -------
    dict
        By the names in ``PATH_NAMES``, each of shape (count, 4, 4): ``matrix`` entry by entry (objects
        shrink on the way), ``quaternion`` a straight line with slerp, ``quaternion, other sign`` the same
        with -q at the end, the same pose but the long way round (the double cover), and ``motor`` the screw.
        Stretch goes entry by entry in all but ``matrix``.
    """
    fraction = np.linspace(0.0, 1.0, count)
    weight = fraction[:, None, None]
    quaternion, motor = FORMS["quaternion"], FORMS["dual_quaternion"]
    ends = quaternion.encode(np.stack([first, last]), stretch=True)
    line, stretch = (_line(ends[:, part], fraction) for part in (slice(0, 3), slice(7, None)))
    turns = ends[:, :7].copy()
    turns[:, :3] = 0.0
    if turns[0, 3:] @ turns[1, 3:] < 0:
        turns[1, 3:] *= -1.0  # so that the signs as given are the short way
    short = sclerp(turns[0], turns[1], fraction, "quaternion", shortest=False)
    other = np.concatenate([turns[1, :3], -turns[1, 3:]])
    long = sclerp(turns[0], other, fraction, "quaternion", shortest=False)
    rigid = motor.encode(np.stack([first, last]))
    screws = np.concatenate([sclerp(rigid[0], rigid[1], fraction), stretch], axis=1)
    return {
        "matrix": (1.0 - weight) * first + weight * last,
        "quaternion": quaternion.decode(np.concatenate([line, short[:, 3:], stretch], axis=1), stretch=True),
        "quaternion, other sign": quaternion.decode(np.concatenate([line, long[:, 3:], stretch], axis=1), stretch=True),
        "motor": motor.decode(screws, stretch=True),
    }


def _line(ends: Floats, fraction: Floats) -> Floats:
    return (1.0 - fraction[:, None]) * ends[0] + fraction[:, None] * ends[1]
