"""Chamfer distance between point clouds, for training."""

from __future__ import annotations

import torch
from torch import Tensor


def chamfer(first: Tensor, second: Tensor) -> Tensor:
    """Symmetric chamfer-L2 distance (B,) between clouds (B, n, 3) and (B, m, 3).

    The mean squared distance from each point to the nearest of the other cloud,
    both directions added, in squared units of the points (Fan et al., "A Point
    Set Generation Network", CVPR 2017). The nearest points are found without
    gradients; the distances to them have gradients.
    """
    with torch.no_grad():
        to_second = _nearest(first, second)
        to_first = _nearest(second, first)
    there = (first - pick(second, to_second)).square().sum(2).mean(1)
    back = (second - pick(first, to_first)).square().sum(2).mean(1)
    return there + back


def pick(points: Tensor, index: Tensor) -> Tensor:
    """Rows (B, m, k) of arrays (B, n, k) by their numbers (B, m)."""
    batch, count, width = points.shape
    rows = index + count * torch.arange(batch)[:, None]
    return points.reshape(batch * count, width).index_select(0, rows.flatten()).reshape(batch, -1, width)


def _nearest(asked: Tensor, known: Tensor) -> Tensor:
    score = torch.bmm(asked * -2, known.transpose(1, 2)) + known.square().sum(2)[:, None]
    return torch.from_numpy(score.numpy().argmin(axis=2))  # on a CPU several times as fast as torch's own
