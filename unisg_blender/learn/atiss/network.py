"""An autoregressive set model in the style of ATISS, at small size: a baseline for the generator.

After Paschalidou et al., "ATISS: Autoregressive Transformers for Indoor Scene
Synthesis" (NeurIPS 2021): a transformer over the set of what stands in the room,
without order among it; mixtures of logistics for each coordinate of the next
object's position, and, given the position, for its heading. As the benchmark
gives categories and shapes, sizes are told and not drawn; the room's outline
comes in as its walls, which are members of the set.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor, nn

FREQUENCIES = 6
SCALE_FLOOR = 0.003
"""Smallest scale of a logistic, metres or radians."""


@dataclass(frozen=True)
class AtissSizes:
    """Number of ``categories`` (one more is kept for unknown ones) and the widths of the layers."""

    categories: int
    embedding: int = 24
    width: int = 64
    heads: int = 4
    layers: int = 3
    logistics: int = 10


class Atiss(nn.Module):
    """:meth:`forward` gives the mixtures of T targets, each of which sees the N objects and no other target."""

    def __init__(self, sizes: AtissSizes) -> None:
        super().__init__()
        self.sizes = sizes
        self.embedding = nn.Embedding(sizes.categories + 1, sizes.embedding)
        waves = 2 * FREQUENCIES
        self.token = nn.Linear(sizes.embedding + 3 * waves + 3 + 6 + 2, sizes.width)
        self.query = nn.Linear(sizes.embedding + 6, sizes.width)
        self.objects = nn.ModuleList(_Block(sizes.width, sizes.heads) for _ in range(sizes.layers))
        self.targets = nn.ModuleList(_Block(sizes.width, sizes.heads) for _ in range(sizes.layers))
        self.norm = nn.LayerNorm(sizes.width)
        self.position = _head(sizes.width, 3 * 3 * sizes.logistics)
        self.heading = _head(sizes.width + 3 * waves + 3, 3 * sizes.logistics)

    def forward(
        self, category: Tensor, box: Tensor, mask: Tensor, target_category: Tensor, target_half: Tensor, place: Tensor
    ) -> tuple[Tensor, Tensor]:
        """The mixtures of each target.

        Parameters
        ----------
        category, box, mask
            int64 (B, N); (B, N, 8): centre, half extents, cosine and sine of the heading; (B, N).
        target_category, target_half
            int64 (B, T) and (B, T, 3), metres.
        place
            (B, T, 3): x, y and bottom of the targets, on which their headings depend.

        Returns
        -------
        Mixtures of position (B, T, 3, 3, M) and heading (B, T, 3, M): log weights, means
        and scales on the axis before the last, metres and radians.
        """
        where = torch.cat([_waves(box[..., :3]), box[..., :3]], -1)
        hidden = self.token(torch.cat([self.embedding(category), where, _size(box[..., 3:6]), box[..., 6:]], -1))
        asked = self.query(torch.cat([self.embedding(target_category), _size(target_half)], -1))
        for obj, target in zip(self.objects, self.targets, strict=True):
            hidden = obj(hidden, hidden, mask)
            asked = target(asked, hidden, mask)
        asked = self.norm(asked)
        position = self.position(asked).unflatten(-1, (3, 3, self.sizes.logistics))
        heading = self.heading(torch.cat([asked, _waves(place), place], -1)).unflatten(-1, (3, self.sizes.logistics))
        return _mixture(position, 3.0), _mixture(heading, math.pi)


class _Block(nn.Module):
    """Pre-norm attention of one set to another, and a feed-forward layer."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.norm, self.norm_seen = nn.LayerNorm(width), nn.LayerNorm(width)
        self.query, self.seen, self.out = nn.Linear(width, width), nn.Linear(width, 2 * width), nn.Linear(width, width)
        self.feed = nn.Sequential(
            nn.LayerNorm(width), nn.Linear(width, 2 * width), nn.GELU(), nn.Linear(2 * width, width)
        )

    def forward(self, asking: Tensor, asked: Tensor, mask: Tensor) -> Tensor:
        """(B, T, width) and (B, N, width) with mask (B, N) to (B, T, width)."""
        query = self.query(self.norm(asking)).unflatten(-1, (self.heads, -1))
        key, value = self.seen(self.norm_seen(asked)).unflatten(-1, (2, self.heads, -1)).unbind(2)
        score = torch.einsum("bihd,bjhd->bhij", query, key) / math.sqrt(query.shape[-1])
        weight = (score + (mask[:, None, None, :] - 1) * 1e4).softmax(-1)
        asking = asking + self.out(torch.einsum("bhij,bjhd->bihd", weight, value).flatten(2))
        return asking + self.feed(asking)


def _head(width: int, out: int) -> nn.Sequential:
    return nn.Sequential(nn.Linear(width, 2 * width), nn.GELU(), nn.Linear(2 * width, out))


def _waves(position: Tensor) -> Tensor:
    """Sines and cosines of metres at wave lengths from 16 m to 0.5 m."""
    angles = torch.cat([position * (2 * math.pi / 16 * 2**step) for step in range(FREQUENCIES)], -1)
    return torch.cat([angles.sin(), angles.cos()], -1)


def _size(half: Tensor) -> Tensor:
    return torch.cat([half, (half + 1e-3).log() * 0.5], dim=-1)


def _mixture(raw: Tensor, reach: float) -> Tensor:
    """Log weights, means and scales (..., 3, M) of what a head gave."""
    weight, mean, scale = raw.unbind(-2)
    spread = torch.linspace(-1, 1, raw.shape[-1], device=raw.device)
    return torch.stack([
        weight.log_softmax(-1), reach * (mean + spread), SCALE_FLOOR + (scale - 1).clamp(-8, 3).exp()
    ], dim=-2)  # fmt: skip
