"""The energy score of drawn places against the true one: proper, so that no spread is rewarded by itself.

The mean distance of the draws from the truth less half the mean distance between two draws; the smaller the better
(Gneiting and Raftery, "Strictly Proper Scoring Rules, Prediction, and Estimation", 2007).
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats
from ..geometry.planar import wrapped

DRAWS = 32


def energy_scores(places: Floats, true: Floats) -> tuple[float, float]:
    """Of places (D, 4) (x, y, bottom z, yaw), two at least, against one (4,): metres, and degrees of heading."""
    far = np.linalg.norm(places[:, :3] - true[:3], axis=1)
    apart = np.linalg.norm(places[:, None, :3] - places[:, :3], axis=2)
    turned = np.abs(wrapped(places[:, 3] - true[3]))
    between = np.abs(wrapped(places[:, None, 3] - places[:, 3]))
    return _score(far, apart), float(np.degrees(_score(turned, between)))


def _score(off: Floats, between: Floats) -> float:
    count = len(off)
    return float(off.mean() - between.sum() / (2 * count * (count - 1)))
