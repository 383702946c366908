"""Negative log-likelihoods of mixtures over places."""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn


def mixture_nll(mixture: tuple[Tensor, ...], box: Tensor, position: Tensor, heading: Tensor) -> Tensor:
    """Negative log-density (B, S) of positions (B, S, 2), metres, and headings (B, S), radians, under a mixture.

    Parameters
    ----------
    mixture
        Log weights (B, M * C), means and spreads (B, M * C, 2) along the axes of M boxes, headings and concentrations
        (B, M * C).
    box
        (B, M, 8), of which the last two are cosine and sine of the heading.
    """
    components = mixture[0].shape[1] // box.shape[1]
    weight, mean, sigma, turn, kappa = (part.unsqueeze(1) for part in mixture)
    offset = position.unsqueeze(2) - mean
    cos = box[..., 6].repeat_interleave(components, dim=1).unsqueeze(1)
    sin = box[..., 7].repeat_interleave(components, dim=1).unsqueeze(1)
    along = (cos * offset[..., 0] + sin * offset[..., 1]) / sigma[..., 0]
    across = (cos * offset[..., 1] - sin * offset[..., 0]) / sigma[..., 1]
    place = -0.5 * (along.square() + across.square()) - sigma.log().sum(-1) - math.log(2 * math.pi)
    bessel = torch.special.i0e(kappa).log() + kappa
    angle = kappa * torch.cos(heading.unsqueeze(2) - turn) - bessel - math.log(2 * math.pi)
    return -torch.logsumexp(weight + place + angle, dim=2)


def height_nll(weight: Tensor, mean: Tensor, sigma: Tensor, height: Tensor) -> Tensor:
    """Negative log-density (B,) of heights (B,) under mixtures (B, LEVELS)."""
    z = (height.unsqueeze(-1) - mean) / sigma
    return -torch.logsumexp(weight - 0.5 * z.square() - sigma.log() - 0.5 * math.log(2 * math.pi), dim=-1)


def logistics_nll(mixture: Tensor, value: Tensor, turn: bool = False) -> Tensor:
    """Negative log-density (...) of values (...) under mixtures (..., 3, M); ``turn``: of angles, which wrap around."""
    weight, mean, scale = mixture.unbind(-2)
    images = [-2 * math.pi, 0.0, 2 * math.pi] if turn else [0.0]
    each = []
    for image in images:
        z = (value.unsqueeze(-1) + image - mean) / scale
        each.append(weight - z - scale.log() - 2 * nn.functional.softplus(-z))
    return -torch.logsumexp(torch.cat(each, -1), -1)
