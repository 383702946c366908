"""The encoder of the conditional VAE around the anchor mixture: what is peculiar about a true pose, as a code."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from .pair_geometry import scale_of

LATENT = 8
POSE_FEATURES = 8


class PoseEncoder(nn.Module):
    """Mean and log variance of the latent code of a target's pose, as the objects around it see it."""

    def __init__(self, embedding: int, flags: int, latent: int, width: int = 48) -> None:
        super().__init__()
        self.each = nn.Sequential(
            nn.Linear(2 * embedding + flags + POSE_FEATURES, width), nn.GELU(), nn.Linear(width, width), nn.GELU()
        )
        self.out = nn.Linear(width, 2 * latent)

    def forward(
        self, target: Tensor, others: Tensor, box: Tensor, flags: Tensor, mask: Tensor, position: Tensor,
        heading: Tensor,
    ) -> tuple[Tensor, Tensor]:  # fmt: skip
        """Mean and log variance (B, latent) of the code.

        Parameters
        ----------
        target, others
            Embeddings of the categories, (B, E) and (B, M, E).
        box, flags, mask
            As for :meth:`.network.AnchorModel.places`.
        position, heading
            (B, 2) metres and (B,) radians in the world.
        """
        seen = _in_frames(box, scale_of(box, flags), position, heading)
        mine = target.unsqueeze(1).expand(-1, others.shape[1], -1)
        hidden = self.each(torch.cat([mine, others, flags, seen], dim=-1)) * mask.unsqueeze(-1)
        pooled = hidden.sum(1) / mask.sum(1, keepdim=True).clamp(min=1)
        mean, spread = self.out(pooled).chunk(2, dim=-1)
        return mean, spread.clamp(-8, 4)


def _in_frames(box: Tensor, scale: Tensor, position: Tensor, heading: Tensor) -> Tensor:
    """A pose as each token sees it, (B, M, POSE_FEATURES)."""
    cos, sin = box[..., 6], box[..., 7]
    dx, dy = (position.unsqueeze(1) - box[..., :2]).unbind(-1)
    x, y = cos * dx + sin * dy, cos * dy - sin * dx
    own_cos, own_sin = heading.cos().unsqueeze(1), heading.sin().unsqueeze(1)
    turn = [cos * own_cos + sin * own_sin, cos * own_sin - sin * own_cos]
    gaps = [(x.abs() - box[..., 3]).clamp(-3, 6), (y.abs() - box[..., 4]).clamp(-3, 6)]
    return torch.stack([x / 3, y / 3, (x / scale).clamp(-4, 4), (y / scale).clamp(-4, 4), *turn, *gaps], dim=-1)
