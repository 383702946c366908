"""How often the density would put a target into an obstacle, as a term of the loss."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor

from .anchor_geometry import depths
from .anchors import COMPONENTS, AnchorModel, mixture_nll

DRAWS = 6
DEEP = 0.01
"""Metres of depth that count as a whole collision."""


def collision_term(
    network: AnchorModel, mixture: tuple[Tensor, ...], batch: Mapping[str, Tensor]
) -> tuple[Tensor, Tensor]:
    """A term whose gradient is that of the chance of a collision, and that chance, each (B,).

    Draws from the mixture are weighted by how deep they reach into obstacles (the score function estimator of
    Williams, "Simple statistical gradient-following algorithms", 1992, with the mean as baseline).
    """
    position, heading = drawn(mixture, batch["box"])
    usual = network.tolerance[batch["target_category"].unsqueeze(1), batch["category"]]
    depth = depths(
        batch["box"], batch["flags"], batch["mask"], batch["target_half"], batch["target_bottom"], usual, position,
        heading,
    )  # fmt: skip
    hit = (depth / DEEP).clamp(0, 1)
    likely = -mixture_nll(mixture, batch["box"], position, heading)
    return ((hit - hit.mean()) * likely).mean(1), hit.mean(1)


@torch.no_grad()
def drawn(mixture: tuple[Tensor, ...], box: Tensor) -> tuple[Tensor, Tensor]:
    """Positions (B, DRAWS, 2) and headings (B, DRAWS) drawn from a mixture; headings by their normal approximation."""
    weight, mean, sigma, heading, kappa = mixture
    part = torch.multinomial(weight.exp(), DRAWS, replacement=True)
    pair = part.unsqueeze(-1).expand(-1, -1, 2)
    along, across = (torch.randn_like(pair, dtype=mean.dtype) * sigma.gather(1, pair)).unbind(-1)
    token = (part // COMPONENTS).unsqueeze(-1).expand(-1, -1, 2)
    cos, sin = box[..., 6:].gather(1, token).unbind(-1)
    offset = torch.stack([cos * along - sin * across, sin * along + cos * across], dim=-1)
    turn = torch.randn(part.shape) / kappa.gather(1, part).sqrt()
    return mean.gather(1, pair) + offset, heading.gather(1, part) + turn
