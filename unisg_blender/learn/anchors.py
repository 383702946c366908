"""The anchor mixture: every thing in view proposes places for the target in its own frame.

A graph network with attention over all pairs of things (their relative poses bias
attention and are passed along with it) gives each thing a score and, for each of
48 base places (flush to its sides, on it, along a wall; four headings), a weight, a
shift, spreads and a heading: a mixture density over the target's position and
heading. The support is chosen, and the height drawn, from pairs of target and
support first. Relative poses only: moving or turning the whole room changes
nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from ..generate.context import PLAN_WIDTH

PLACES, TURNS = 12, 4
COMPONENTS = PLACES * TURNS
LEVELS = 6
PAIR_FEATURES = 28
FLAGS = 6
SIGMA_FLOOR = 0.004
LOG_KAPPA = (-2.0, 9.0)


@dataclass(frozen=True)
class AnchorSizes:
    """Number of ``categories`` (one more is kept for unknown ones) and the widths of the layers."""

    categories: int
    embedding: int = 24
    width: int = 96
    heads: int = 4
    layers: int = 3
    pair: int = 32


class AnchorModel(nn.Module):
    """:meth:`forward` is what the exported model computes: supports and heights, then places."""

    def __init__(self, sizes: AnchorSizes) -> None:
        super().__init__()
        self.sizes = sizes
        self.embedding = nn.Embedding(sizes.categories + 1, sizes.embedding)
        both = 2 * sizes.embedding + 6 + 6 + 4 + sizes.embedding
        self.support = nn.Sequential(nn.Linear(both, 96), nn.GELU(), nn.Linear(96, 64), nn.GELU())
        self.support_score = nn.Linear(64, 1)
        self.height = nn.Linear(64, LEVELS * 5)
        self.target = nn.Linear(2 * sizes.embedding + 6 + PLAN_WIDTH, sizes.width)
        self.token = nn.Linear(sizes.embedding + 6 + 6 + FLAGS, sizes.width)
        self.pair = nn.Sequential(nn.Linear(PAIR_FEATURES, sizes.pair), nn.GELU(), nn.Linear(sizes.pair, sizes.pair))
        self.layers = nn.ModuleList(_PairAttention(sizes) for _ in range(sizes.layers))
        self.norm = nn.LayerNorm(sizes.width)
        self.pool = nn.Linear(sizes.width, 1)
        last = nn.Linear(96, COMPONENTS * 7)
        nn.init.zeros_(last.bias)
        nn.init.normal_(last.weight, std=0.02)
        self.head = nn.Sequential(nn.Linear(3 * sizes.width, 96), nn.GELU(), last)
        self.score = nn.Sequential(nn.Linear(3 * sizes.width, 48), nn.GELU(), nn.Linear(48, 1))

    def choose(
        self, target_category: Tensor, target_half: Tensor, coming: Tensor, support_category: Tensor,
        support_half: Tensor, support_load: Tensor,
    ) -> tuple[Tensor, Tensor, Tensor, Tensor]:  # fmt: skip
        """Scores of K supports for B targets, and for each the mixture of heights above its bottom.

        Returns
        -------
        score (B, K), log weights, means and spreads (B, K, LEVELS), metres.
        """
        count = support_category.shape[1]
        plan = coming @ self.embedding.weight[:-1]
        mine = torch.cat([self.embedding(target_category), _size_features(target_half), plan], dim=-1)
        there = torch.cat([self.embedding(support_category), _size_features(support_half), support_load], dim=-1)
        hidden = self.support(torch.cat([mine.unsqueeze(1).expand(-1, count, -1), there], dim=-1))
        weight, of_support, of_target, shift, spread = self.height(hidden).unflatten(-1, (5, LEVELS)).unbind(-2)
        steps = torch.linspace(0, 1, LEVELS)
        mean = (of_support + steps) * 2 * support_half[..., 2:] + of_target * 2 * target_half[:, None, 2:] + shift
        return self.support_score(hidden).squeeze(-1), weight.log_softmax(-1), mean, SIGMA_FLOOR + (spread - 3).exp()

    def places(
        self, target_category: Tensor, target_half: Tensor, target_bottom: Tensor, plan: Tensor, coming: Tensor,
        category: Tensor, box: Tensor, flags: Tensor, mask: Tensor,
    ) -> tuple[Tensor, Tensor, Tensor, Tensor, Tensor]:  # fmt: skip
        """The mixture over places of B targets among M tokens each.

        Parameters
        ----------
        target_category, target_half, target_bottom
            int64 (B,), (B, 3) and (B,): what is placed, half extents and height of its bottom, metres.
        plan, coming
            (B, PLAN_WIDTH) and (B, C), see :mod:`..generate.context`.
        category, box, flags, mask
            int64 (B, M), (B, M, 8): centre, half extents, cosine and sine of the heading, (B, M, FLAGS), (B, M).

        Returns
        -------
        Log weights (B, M * 48), means (B, M * 48, 2) and headings (B, M * 48) in the world, spreads
        (B, M * 48, 2) along the token's axes, and concentrations (B, M * 48).
        """
        context = self._encode(target_category, target_half, target_bottom, plan, coming, category, box, flags, mask)
        raw = self.head(context).unflatten(-1, (COMPONENTS, 7))
        logit, shift_x, shift_y, spread_x, spread_y, lean, kappa = raw.unbind(-1)
        scale = _scale(box, flags).unsqueeze(-1)
        sigma_x = SIGMA_FLOOR + scale * (spread_x - 2.5).clamp(-6, 2).exp()
        sigma_y = SIGMA_FLOOR + scale * (spread_y - 2.5).clamp(-6, 2).exp()
        base_x, base_y, turn = base_places(box, flags, target_half)
        local_x, local_y = base_x + sigma_x * shift_x, base_y + sigma_y * shift_y
        x, y, cos, sin = box[..., 0:1], box[..., 1:2], box[..., 6:7], box[..., 7:8]
        mean = torch.stack([x + cos * local_x - sin * local_y, y + sin * local_x + cos * local_y], dim=-1)
        heading = torch.atan2(sin, cos) + turn + (math.pi / 4) * torch.tanh(lean)
        score = self.score(context) + logit + (mask.unsqueeze(-1) - 1) * 1e4
        weight = score.flatten(1).log_softmax(-1)
        sigma = torch.stack([sigma_x, sigma_y], dim=-1)
        low, high = LOG_KAPPA
        kappa = (kappa + 2).clamp(low, high).exp()
        return weight, mean.flatten(1, 2), sigma.flatten(1, 2), heading.flatten(1), kappa.flatten(1)

    def _encode(
        self, target_category: Tensor, target_half: Tensor, target_bottom: Tensor, plan: Tensor, coming: Tensor,
        category: Tensor, box: Tensor, flags: Tensor, mask: Tensor,
    ) -> Tensor:  # fmt: skip
        ahead = coming @ self.embedding.weight[:-1]
        target = self.target(torch.cat([self.embedding(target_category), ahead, _size_features(target_half), plan], -1))
        bottom, top = target_bottom.unsqueeze(1), (target_bottom + 2 * target_half[:, 2]).unsqueeze(1)
        low, high = box[..., 2] - box[..., 5], box[..., 2] + box[..., 5]
        overlap = (torch.minimum(high, top) - torch.maximum(low, bottom)).clamp(-1, 3)
        tall = torch.stack([low, high, low - bottom, high - bottom, overlap, (overlap > 0).float()], dim=-1)
        token = torch.cat([self.embedding(category), _size_features(box[..., 3:6]), tall, flags], dim=-1)
        hidden = self.token(token) + target.unsqueeze(1)
        pair = self.pair(pair_features(box, _scale(box, flags)))
        for layer in self.layers:
            hidden = layer(hidden, pair, mask)
        hidden = self.norm(hidden)
        weight = (self.pool(hidden).squeeze(-1) + (mask - 1) * 1e4).softmax(-1)
        pooled = target + (weight.unsqueeze(-1) * hidden).sum(1)
        parent = (flags[..., :1] * hidden).sum(1)
        context = torch.cat([pooled, parent], dim=-1).unsqueeze(1).expand(-1, hidden.shape[1], -1)
        return torch.cat([hidden, context], dim=-1)

    def forward(
        self, target_category: Tensor, target_half: Tensor, target_bottom: Tensor, plan: Tensor, coming: Tensor,
        category: Tensor, box: Tensor, flags: Tensor, mask: Tensor, support_category: Tensor, support_half: Tensor,
        support_load: Tensor,
    ) -> tuple[Tensor, ...]:  # fmt: skip
        """What :meth:`choose` and :meth:`places` return, one after the other."""
        chosen = self.choose(target_category, target_half, coming, support_category, support_half, support_load)
        placed = self.places(target_category, target_half, target_bottom, plan, coming, category, box, flags, mask)
        return (*chosen, *placed)


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


def _scale(box: Tensor, flags: Tensor) -> Tensor:
    """The size of the support, (B, 1): half its longer side; 1 m where there is none."""
    longest = (flags[..., 0] * box[..., 3:5].amax(-1)).sum(1, keepdim=True)
    return torch.where(longest > 0, longest, torch.ones_like(longest)).clamp(0.05, 4.0)


def pair_features(box: Tensor, scale: Tensor) -> Tensor:
    """How token j lies in token i's frame, (B, M, M, 28): offsets, turns, gaps; plain and by the support's size."""
    offset = box[:, None, :, :3] - box[:, :, None, :3]
    cos, sin = box[:, :, None, 6], box[:, :, None, 7]
    x = cos * offset[..., 0] + sin * offset[..., 1]
    y = cos * offset[..., 1] - sin * offset[..., 0]
    turn_cos = cos * box[:, None, :, 6] + sin * box[:, None, :, 7]
    turn_sin = cos * box[:, None, :, 7] - sin * box[:, None, :, 6]
    wide = turn_cos.abs() * box[:, None, :, 3] + turn_sin.abs() * box[:, None, :, 4]
    deep = turn_sin.abs() * box[:, None, :, 3] + turn_cos.abs() * box[:, None, :, 4]
    gap_x, gap_y = x.abs() - box[:, :, None, 3] - wide, y.abs() - box[:, :, None, 4] - deep
    s = scale.unsqueeze(-1)
    scaled = [(x / s).clamp(-4, 4), (y / s).clamp(-4, 4)]
    waves = [wave(f * math.pi / 2 * value) for f in (1, 2, 4) for value in scaled for wave in (torch.sin, torch.cos)]
    waves += [wave(1.5 * value) for value in (x, y) for wave in (torch.sin, torch.cos)]
    gaps = [gap_x.clamp(-3, 6), gap_y.clamp(-3, 6), (gap_x / s).clamp(-3, 4), (gap_y / s).clamp(-3, 4)]
    distance = (x.square() + y.square() + 1e-6).sqrt()
    return torch.stack([x / 3, y / 3, *scaled, *waves, turn_cos, turn_sin, *gaps, offset[..., 2], distance / 3], dim=-1)


def base_places(box: Tensor, flags: Tensor, target_half: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Base places in each token's frame, x and y (B, M, 48) metres, and their headings (48,) radians.

    Component ``p * 4 + t`` is place p with the target turned t quarters. Neighbours
    have the target flush to a side, at either end or in the middle; the support has
    it in a 3 x 3 grid on itself and between; walls along their inner side, touching
    or half a metre off.
    """
    a, b = box[..., 3, None], box[..., 4, None]
    quarter = torch.arange(TURNS).repeat(PLACES)
    turned = (quarter % 2 == 1).to(box.dtype)
    p = (target_half[:, 0, None] * (1 - turned) + target_half[:, 1, None] * turned).unsqueeze(1)
    q = (target_half[:, 1, None] * (1 - turned) + target_half[:, 0, None] * turned).unsqueeze(1)

    def row(values: Sequence[float]) -> Tensor:
        return torch.tensor(values).repeat_interleave(TURNS)

    along, side = row([-1, 0, 1] * 4), row([1] * 3 + [-1] * 3 + [1] * 3 + [-1] * 3)
    end = row([1.0] * 6 + [0.0] * 6)
    beside_x = end * side * (a + p) + (1 - end) * along * (a - p)
    beside_y = end * along * (b - q) + (1 - end) * side * (b + q)
    grid_x, grid_y = row([-1, -1, -1, 0, 0, 0, 1, 1, 1, -0.5, 0.5, 0]), row([-1, 0, 1, -1, 0, 1, -1, 0, 1, 0, 0, 0.5])
    on_x, on_y = grid_x * (a - p).clamp(min=0), grid_y * (b - q).clamp(min=0)
    inner = flags[..., 4, None]
    wall_x = row([-1, -0.6, -0.2, 0.2, 0.6, 1] * 2) * (a - p).clamp(min=0)
    wall_y = inner * (b + q + row([0.0] * 6 + [0.5] * 6))
    parent, wall = flags[..., 0, None], inner.abs()
    free = (1 - wall) * (1 - parent)
    x = wall * wall_x + (1 - wall) * parent * on_x + free * beside_x
    y = wall * wall_y + (1 - wall) * parent * on_y + free * beside_y
    return x, y, quarter * (math.pi / 2)


def mixture_nll(mixture: tuple[Tensor, ...], box: Tensor, position: Tensor, heading: Tensor) -> Tensor:
    """Negative log-density (B,) of true positions (B, 2) and headings (B,) under :meth:`AnchorModel.places`."""
    weight, mean, sigma, turn, kappa = mixture
    offset = position.unsqueeze(1) - mean
    cos = box[..., 6].repeat_interleave(COMPONENTS, dim=1)
    sin = box[..., 7].repeat_interleave(COMPONENTS, dim=1)
    along = (cos * offset[..., 0] + sin * offset[..., 1]) / sigma[..., 0]
    across = (cos * offset[..., 1] - sin * offset[..., 0]) / sigma[..., 1]
    place = -0.5 * (along.square() + across.square()) - sigma.log().sum(-1) - math.log(2 * math.pi)
    bessel = torch.special.i0e(kappa).log() + kappa
    angle = kappa * torch.cos(heading.unsqueeze(1) - turn) - bessel - math.log(2 * math.pi)
    return -torch.logsumexp(weight + place + angle, dim=1)


def height_nll(weight: Tensor, mean: Tensor, sigma: Tensor, height: Tensor) -> Tensor:
    """Negative log-density (B,) of heights (B,) under mixtures (B, LEVELS)."""
    z = (height.unsqueeze(-1) - mean) / sigma
    return -torch.logsumexp(weight - 0.5 * z.square() - sigma.log() - 0.5 * math.log(2 * math.pi), dim=-1)
