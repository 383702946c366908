"""Rigid poses seen from one another."""

from __future__ import annotations

import numpy as np

from .arrays import Floats, Ints


def relative_poses(poses: Floats, pairs: Ints) -> Floats:
    """The second's pose in the first's frame, (P, 4, 4), of pairs (P, 2) of rigid poses (N, 4, 4)."""
    first, second = poses[pairs[:, 0]], poses[pairs[:, 1]]
    result = np.zeros_like(first)
    turn = np.swapaxes(first[:, :3, :3], 1, 2)
    result[:, :3, :3] = turn @ second[:, :3, :3]
    result[:, :3, 3] = np.einsum("pij,pj->pi", turn, second[:, :3, 3] - first[:, :3, 3])
    result[:, 3, 3] = 1
    return result
