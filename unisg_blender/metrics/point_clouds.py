"""How near two surfaces are: chamfer distance and F-score between point clouds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..geometry.arrays import Floats


def chamfer_l2(first: NDArray[np.floating], second: NDArray[np.floating]) -> float:
    """Mean squared distance to the nearest point of the other cloud, both directions added, in squared units.

    The clouds are (P, 3) and (Q, 3).
    """
    there, back = nearest_distances(first, second)
    return float(np.square(there).mean() + np.square(back).mean())


def f_score(first: NDArray[np.floating], second: NDArray[np.floating], threshold: float) -> float:
    """Harmonic mean of the shares of points of either cloud that lie within a threshold of the other, 0..1.

    The clouds are (P, 3) and (Q, 3); the threshold is in their unit.
    Knapitsch et al., "Tanks and Temples", SIGGRAPH 2017.
    """
    there, back = nearest_distances(first, second)
    precision, recall = float((there < threshold).mean()), float((back < threshold).mean())
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0


def nearest_distances(first: NDArray[np.floating], second: NDArray[np.floating]) -> tuple[Floats, Floats]:
    """Distances (n,) from each point of one cloud (n, 3) to the nearest of the other (m, 3), and back (m,)."""
    return np.asarray(cKDTree(second).query(first)[0]), np.asarray(cKDTree(first).query(second)[0])


def diagonal(points: NDArray[np.floating]) -> float:
    """Length of the diagonal of the box around points (n, 3)."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))
