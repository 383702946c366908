"""From our frame, z up, to glTF's, y up: a point (x, y, z) is (x, z, -y) there; exact, numbers only change places."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

PLACES = [0, 2, 1]
SIGNS = np.array([1.0, 1.0, -1.0])


def turned_points(points: NDArray[Any]) -> NDArray[Any]:
    """Points or directions (K, 3)."""
    return points[:, PLACES] * SIGNS.astype(points.dtype)


def turned_matrices(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Affine matrices (K, 4, 4) between frames, both of which are turned."""
    result = matrices.copy()
    result[:, :3, :3] = matrices[:, :3][:, PLACES][:, :, PLACES] * SIGNS[:, None] * SIGNS
    result[:, :3, 3] = matrices[:, PLACES, 3] * SIGNS
    return result
