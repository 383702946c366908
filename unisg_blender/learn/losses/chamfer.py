"""Chamfer distance between point clouds, for training."""

from __future__ import annotations

import torch
from torch import Tensor

from ..tensor_rows import largest, pick


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


def _nearest(asked: Tensor, known: Tensor) -> Tensor:
    return largest(torch.bmm(asked * 2, known.transpose(1, 2)) - known.square().sum(2)[:, None])
