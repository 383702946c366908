"""The anchor mixture: every object in view proposes places for the target in its own frame.

A graph network with attention over all pairs of objects (their relative poses bias
attention and are passed along with it) gives each object a score and, for each of
48 base places (flush to its sides, on it, along a wall; four headings), a weight, a
shift, spreads and a heading: a mixture density over the target's position and
heading. The support is chosen, and the height drawn, from pairs of target and
support first. Relative poses only: moving or turning the whole room changes
nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from ...generate.observe.scene_tokens import FLAGS, PLAN_WIDTH
from ...generate.observe.support_candidates import OCCUPANCY_WIDTH
from .critic import PlaceCritic
from .pair_geometry import PAIR_FEATURES, PLACES, TURNS, base_places, pair_features, scale_of
from .pose_encoder import LATENT, PoseEncoder

COMPONENTS = PLACES * TURNS
LEVELS = 6
SIGMA_FLOOR = 0.002
LOG_KAPPA = (-2.0, 9.0)
NARROW = 8
"""Rows or columns of a matrix that makes a single number or so of each object."""


@dataclass(frozen=True)
class AnchorSizes:
    """Number of ``categories`` (one more is kept for unknown ones) and the widths of the layers."""

    categories: int
    embedding: int = 24
    width: int = 96
    heads: int = 4
    layers: int = 2
    pair: int = 32
    latent: int = LATENT


class AnchorModel(nn.Module):
    """:meth:`forward` is what the exported model computes: supports and heights, then places."""

    def __init__(self, sizes: AnchorSizes) -> None:
        super().__init__()
        self.sizes = sizes
        self.embedding = nn.Embedding(sizes.categories + 1, sizes.embedding)
        both = 6 * sizes.embedding + 6 + 6 + 1 + OCCUPANCY_WIDTH
        self.support = nn.Sequential(nn.Linear(both, 96), nn.GELU(), nn.Linear(96, 64), nn.GELU())
        self.support_score = nn.Linear(64, 1)
        self.height = nn.Linear(64, LEVELS * 5)
        self.target = nn.Linear(2 * sizes.embedding + 6 + PLAN_WIDTH + sizes.latent, sizes.width)
        self.encoder = PoseEncoder(sizes.embedding, FLAGS, sizes.latent) if sizes.latent else None
        self.token = nn.Linear(sizes.embedding + 6 + 6 + FLAGS, sizes.width)
        self.pair = nn.Sequential(nn.Linear(PAIR_FEATURES, sizes.pair), nn.GELU(), nn.Linear(sizes.pair, sizes.pair))
        self.layers = nn.ModuleList(_PairAttention(sizes) for _ in range(sizes.layers))
        self.norm = nn.LayerNorm(sizes.width)
        self.pool = nn.Linear(sizes.width, 1)
        last = nn.Linear(96, COMPONENTS * 7)
        nn.init.zeros_(last.bias)
        nn.init.normal_(last.weight, std=0.02)
        self.head = nn.Sequential(nn.Linear(3 * sizes.width, 96), nn.GELU(), last)
        self.critic = PlaceCritic(3 * sizes.width)
        self.score = nn.Sequential(nn.Linear(3 * sizes.width, 48), nn.GELU(), nn.Linear(48, 1))

    def hidden_matrices(self) -> list[nn.Parameter]:
        """The weights between hidden layers: all but embeddings and what makes outputs."""
        layers = [layer for layer in self.modules() if isinstance(layer, nn.Linear) and layer is not self.head[-1]]
        weights = [part for layer in layers for part in layer.parameters() if part.ndim == 2]
        return [weight for weight in weights if min(weight.shape) >= NARROW]

    def choose(
        self, target_category: Tensor, target_half: Tensor, coming: Tensor, whole: Tensor, support_category: Tensor,
        support_holder: Tensor, support_half: Tensor, support_load: Tensor, support_content: Tensor,
        support_near: Tensor,
    ) -> tuple[Tensor, Tensor, Tensor, Tensor]:  # fmt: skip
        """Scores of K candidates for B targets, and for each the mixture of heights above its object's bottom.

        Returns
        -------
        score (B, K), log weights, means and spreads (B, K, LEVELS), metres.
        """
        count = support_category.shape[1]
        ahead = coming @ self.embedding.weight[:-1]
        mine = torch.cat(
            [self.embedding(target_category), _size_features(target_half), ahead, whole.unsqueeze(1)], dim=-1
        )
        there = torch.cat([
            self.embedding(support_category), self.embedding(support_holder), _size_features(support_half),
            support_load, support_content @ self.embedding.weight, support_near @ self.embedding.weight,
        ], dim=-1)  # fmt: skip
        hidden = self.support(torch.cat([mine.unsqueeze(1).expand(-1, count, -1), there], dim=-1))
        weight, of_support, of_target, shift, spread = self.height(hidden).unflatten(-1, (5, LEVELS)).unbind(-2)
        steps = torch.linspace(0, 1, LEVELS)
        mean = (of_support + steps) * 2 * support_half[..., 2:] + of_target * 2 * target_half[:, None, 2:] + shift
        return self.support_score(hidden).squeeze(-1), weight.log_softmax(-1), mean, SIGMA_FLOOR + (spread - 3).exp()

    def places(
        self, target_category: Tensor, target_half: Tensor, target_bottom: Tensor, plan: Tensor, row: Tensor,
        latent: Tensor, category: Tensor, box: Tensor, flags: Tensor, mask: Tensor,
    ) -> tuple[Tensor, Tensor, Tensor, Tensor, Tensor, Tensor]:  # fmt: skip
        """The mixture over places of B targets among M tokens each, and what :meth:`judge` needs to know.

        Parameters
        ----------
        target_category, target_half, target_bottom
            int64 (B,), (B, 3) and (B,): what is placed, half extents and height of its bottom, metres.
        plan, row
            (B, PLAN_WIDTH) and (B, C), what is still to come to this surface: :mod:`...generate.observe.scene_tokens`.
        latent
            (B, latent): drawn from a standard normal, or what the encoder makes of the true pose.
        category, box, flags, mask
            int64 (B, M), (B, M, 8): centre, half extents, cosine and sine of the heading, (B, M, FLAGS), (B, M).

        Returns
        -------
        Log weights (B, M * 48), means (B, M * 48, 2) and headings (B, M * 48) in the world, spreads
        (B, M * 48, 2) along the token's axes, concentrations (B, M * 48), and the view (B, M, 3 * width).
        """
        context = self._encode(
            target_category, target_half, target_bottom, plan, row, latent, category, box, flags, mask
        )
        raw = self.head(context).unflatten(-1, (COMPONENTS, 7))
        logit, shift_x, shift_y, spread_x, spread_y, lean, kappa = raw.unbind(-1)
        scale = scale_of(box, flags).unsqueeze(-1)
        sigma_x = SIGMA_FLOOR + scale * (spread_x - 2.5).clamp(-6, 2).exp()
        sigma_y = SIGMA_FLOOR + scale * (spread_y - 2.5).clamp(-6, 2).exp()
        base_x, base_y, turn = base_places(box, flags, target_half, target_bottom)
        local_x, local_y = base_x + sigma_x * shift_x, base_y + sigma_y * shift_y
        x, y, cos, sin = box[..., 0:1], box[..., 1:2], box[..., 6:7], box[..., 7:8]
        mean = torch.stack([x + cos * local_x - sin * local_y, y + sin * local_x + cos * local_y], dim=-1)
        heading = torch.atan2(sin, cos) + turn + (math.pi / 4) * torch.tanh(lean)
        score = self.score(context) + logit + (mask.unsqueeze(-1) - 1) * 1e4
        weight = score.flatten(1).log_softmax(-1)
        sigma = torch.stack([sigma_x, sigma_y], dim=-1)
        low, high = LOG_KAPPA
        kappa = (kappa + 2).clamp(low, high).exp()
        return weight, mean.flatten(1, 2), sigma.flatten(1, 2), heading.flatten(1), kappa.flatten(1), context

    def judge(
        self, target_half: Tensor, target_bottom: Tensor, box: Tensor, flags: Tensor, mask: Tensor, view: Tensor,
        place: Tensor,
    ) -> Tensor:  # fmt: skip
        """Log ratios (B, S), see :class:`.critic.PlaceCritic`, of places (B, S, 3) in a ``view`` (B, M, 3 W)."""
        return self.critic(view, box, mask, scale_of(box, flags), target_half, target_bottom, place)

    def _encode(
        self, target_category: Tensor, target_half: Tensor, target_bottom: Tensor, plan: Tensor, row: Tensor,
        latent: Tensor, category: Tensor, box: Tensor, flags: Tensor, mask: Tensor,
    ) -> Tensor:  # fmt: skip
        ahead = row @ self.embedding.weight[:-1]
        target = self.target(
            torch.cat([self.embedding(target_category), ahead, _size_features(target_half), plan, latent], -1)
        )
        bottom, top = target_bottom.unsqueeze(1), (target_bottom + 2 * target_half[:, 2]).unsqueeze(1)
        low, high = box[..., 2] - box[..., 5], box[..., 2] + box[..., 5]
        overlap = (torch.minimum(high, top) - torch.maximum(low, bottom)).clamp(-1, 3)
        tall = torch.stack([low, high, low - bottom, high - bottom, overlap, (overlap > 0).float()], dim=-1)
        token = torch.cat([self.embedding(category), _size_features(box[..., 3:6]), tall, flags], dim=-1)
        hidden = self.token(token) + target.unsqueeze(1)
        pair = self.pair(pair_features(box, scale_of(box, flags), box))
        for layer in self.layers:
            hidden = layer(hidden, pair, mask)
        hidden = self.norm(hidden)
        weight = (self.pool(hidden).squeeze(-1) + (mask - 1) * 1e4).softmax(-1)
        pooled = target + (weight.unsqueeze(-1) * hidden).sum(1)
        parent = (flags[..., :1] * hidden).sum(1)
        context = torch.cat([pooled, parent], dim=-1).unsqueeze(1).expand(-1, hidden.shape[1], -1)
        return torch.cat([hidden, context], dim=-1)

    def forward(
        self, target_category: Tensor, target_half: Tensor, target_bottom: Tensor, plan: Tensor, row: Tensor,
        latent: Tensor, category: Tensor, box: Tensor, flags: Tensor, mask: Tensor, coming: Tensor, whole: Tensor,
        support_category: Tensor, support_holder: Tensor, support_half: Tensor, support_load: Tensor,
        support_content: Tensor, support_near: Tensor, view: Tensor, place: Tensor,
    ) -> tuple[Tensor, ...]:  # fmt: skip
        """What :meth:`choose`, :meth:`places` and, in a given ``view``, :meth:`judge` return, one after the other."""
        chosen = self.choose(
            target_category, target_half, coming, whole, support_category, support_holder, support_half, support_load,
            support_content, support_near,
        )  # fmt: skip
        placed = self.places(target_category, target_half, target_bottom, plan, row, latent, category, box, flags, mask)
        return (*chosen, *placed, self.judge(target_half, target_bottom, box, flags, mask, view, place))


class _PairAttention(nn.Module):
    """A pre-norm attention layer whose scores and values also come from pairs."""

    def __init__(self, sizes: AnchorSizes) -> None:
        super().__init__()
        self.heads, self.width = sizes.heads, sizes.width
        self.norm = nn.LayerNorm(sizes.width)
        self.queries = nn.Linear(sizes.width, 3 * sizes.width)
        self.bias = nn.Linear(sizes.pair, sizes.heads)
        self.out = nn.Linear(sizes.width + sizes.heads * sizes.pair, sizes.width)
        self.feed = nn.Sequential(
            nn.LayerNorm(sizes.width), nn.Linear(sizes.width, 2 * sizes.width), nn.GELU(),
            nn.Linear(2 * sizes.width, sizes.width),
        )  # fmt: skip

    def forward(self, hidden: Tensor, pair: Tensor, mask: Tensor) -> Tensor:
        """(B, M, width), (B, M, M, pair), (B, M) to (B, M, width)."""
        query, key, value = self.queries(self.norm(hidden)).unflatten(-1, (3, self.heads, -1)).unbind(2)
        score = torch.einsum("bihd,bjhd->bhij", query, key) / math.sqrt(self.width / self.heads)
        score = score + self.bias(pair).permute(0, 3, 1, 2) + (mask[:, None, None, :] - 1) * 1e4
        weight = score.softmax(-1)
        seen = torch.einsum("bhij,bjhd->bihd", weight, value).flatten(2)
        between = torch.einsum("bhij,bijp->bihp", weight, pair).flatten(2)
        hidden = hidden + self.out(torch.cat([seen, between], dim=-1))
        return hidden + self.feed(hidden)


def _size_features(half: Tensor) -> Tensor:
    return torch.cat([half, (half + 1e-3).log() * 0.5], dim=-1)
