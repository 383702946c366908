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
from collections.abc import Mapping
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
    """:meth:`forward` is what the exported model computes: supports and heights, then places.

    Inputs come by name, as :mod:`...generate.propose.anchor_inputs` lists them.
    """

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

    def choose(self, inputs: Mapping[str, Tensor]) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Scores of K candidates for B targets, and for each the mixture of heights above its object's bottom.

        ``inputs`` has the target's category and half extents, and :data:`SUPPORT_INPUTS`.

        Returns
        -------
        score (B, K), log weights, means and spreads (B, K, LEVELS), metres.
        """
        target_half, support_half, embedding = inputs["target_half"], inputs["support_half"], self.embedding.weight
        ahead, whole = inputs["coming"] @ embedding[:-1], inputs["whole"].unsqueeze(1)
        mine = torch.cat([self.embedding(inputs["target_category"]), _size_features(target_half), ahead, whole], dim=-1)
        there = torch.cat([
            self.embedding(inputs["support_category"]), self.embedding(inputs["support_holder"]),
            _size_features(support_half), inputs["support_load"], inputs["support_content"] @ embedding,
            inputs["support_near"] @ embedding,
        ], dim=-1)  # fmt: skip
        hidden = self.support(torch.cat([mine.unsqueeze(1).expand(-1, there.shape[1], -1), there], dim=-1))
        weight, of_support, of_target, shift, spread = self.height(hidden).unflatten(-1, (5, LEVELS)).unbind(-2)
        steps = torch.linspace(0, 1, LEVELS, device=hidden.device)
        mean = (of_support + steps) * 2 * support_half[..., 2:] + of_target * 2 * target_half[:, None, 2:] + shift
        return self.support_score(hidden).squeeze(-1), weight.log_softmax(-1), mean, SIGMA_FLOOR + (spread - 3).exp()

    def places(self, inputs: Mapping[str, Tensor]) -> tuple[Tensor, Tensor, Tensor, Tensor, Tensor, Tensor]:
        """The mixture over places of B targets among M tokens each, and what :meth:`judge` needs to know.

        ``inputs`` has :data:`PLACE_INPUTS`.

        Returns
        -------
        Log weights (B, M * 48), means (B, M * 48, 2) and headings (B, M * 48) in the world, spreads
        (B, M * 48, 2) along the token's axes, concentrations (B, M * 48), and the view (B, M, 3 * width).
        """
        box, flags, context = inputs["box"], inputs["flags"], self._encode(inputs)
        raw = self.head(context).unflatten(-1, (COMPONENTS, 7))
        logit, shift_x, shift_y, spread_x, spread_y, lean, kappa = raw.unbind(-1)
        scale = scale_of(box, flags).unsqueeze(-1)
        sigma_x = SIGMA_FLOOR + scale * (spread_x - 2.5).clamp(-6, 2).exp()
        sigma_y = SIGMA_FLOOR + scale * (spread_y - 2.5).clamp(-6, 2).exp()
        base_x, base_y, turn = base_places(box, flags, inputs["target_half"], inputs["target_bottom"])
        local_x, local_y = base_x + sigma_x * shift_x, base_y + sigma_y * shift_y
        x, y, cos, sin = box[..., 0:1], box[..., 1:2], box[..., 6:7], box[..., 7:8]
        mean = torch.stack([x + cos * local_x - sin * local_y, y + sin * local_x + cos * local_y], dim=-1)
        heading = torch.atan2(sin, cos) + turn + (math.pi / 4) * torch.tanh(lean)
        score = self.score(context) + logit + (inputs["mask"].unsqueeze(-1) - 1) * 1e4
        weight = score.flatten(1).log_softmax(-1)
        sigma = torch.stack([sigma_x, sigma_y], dim=-1)
        low, high = LOG_KAPPA
        kappa = (kappa + 2).clamp(low, high).exp()
        return weight, mean.flatten(1, 2), sigma.flatten(1, 2), heading.flatten(1), kappa.flatten(1), context

    def judge(self, inputs: Mapping[str, Tensor], view: Tensor, place: Tensor) -> Tensor:
        """Log ratios (B, S), see :class:`.critic.PlaceCritic`, of places (B, S, 3) in a ``view`` (B, M, 3 W)."""
        box, half, bottom = inputs["box"], inputs["target_half"], inputs["target_bottom"]
        return self.critic(view, box, inputs["mask"], scale_of(box, inputs["flags"]), half, bottom, place)

    def _encode(self, inputs: Mapping[str, Tensor]) -> Tensor:
        box, flags, mask = inputs["box"], inputs["flags"], inputs["mask"]
        target_half, target_bottom = inputs["target_half"], inputs["target_bottom"]
        ahead, size = inputs["row"] @ self.embedding.weight[:-1], _size_features(target_half)
        of_target = [self.embedding(inputs["target_category"]), ahead, size, inputs["plan"], inputs["latent"]]
        target = self.target(torch.cat(of_target, -1))
        bottom, top = target_bottom.unsqueeze(1), (target_bottom + 2 * target_half[:, 2]).unsqueeze(1)
        low, high = box[..., 2] - box[..., 5], box[..., 2] + box[..., 5]
        overlap = (torch.minimum(high, top) - torch.maximum(low, bottom)).clamp(-1, 3)
        tall = torch.stack([low, high, low - bottom, high - bottom, overlap, (overlap > 0).float()], dim=-1)
        token = torch.cat([self.embedding(inputs["category"]), _size_features(box[..., 3:6]), tall, flags], dim=-1)
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

    def forward(self, **inputs: Tensor) -> tuple[Tensor, ...]:
        """What :meth:`choose`, :meth:`places` and :meth:`judge` return for all inputs, one after another."""
        return *self.choose(inputs), *self.places(inputs), self.judge(inputs, inputs["view"], inputs["place"])


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
