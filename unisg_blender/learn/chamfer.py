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
        product = torch.bmm(first, second.transpose(1, 2))
        score = product * -2 + second.square().sum(2)[:, None]
        to_second = score.argmin(dim=2)
        to_first = (score + first.square().sum(2)[:, :, None]).argmin(dim=1)
    there = (first - _pick(second, to_second)).square().sum(2).mean(1)
    back = (second - _pick(first, to_first)).square().sum(2).mean(1)
    return there + back


def _pick(points: Tensor, index: Tensor) -> Tensor:
    return torch.gather(points, 1, index[:, :, None].expand(-1, -1, 3))
