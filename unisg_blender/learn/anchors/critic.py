"""The critic of proposed places: how much likelier a place is among true ones than among the mixture's draws.

A mixture is quick to draw from but cannot carve out where objects may not stand, or say that
a screen stands before its sofa and along its wall at once. The critic sees how a place
lies to everything in view, and is trained to tell the true place among draws
(ranking noise-contrastive estimation: Ma and Collins, "Noise Contrastive Estimation and Negative Sampling for
Conditional Models", EMNLP 2018). What it says is the logarithm of a ratio of densities up to a constant, so
drawing among draws by it (sampling-importance resampling: Rubin 1988) corrects the mixture.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn

from ...generate.propose.mixture import TAIL
from .pair_geometry import PAIR_FEATURES, pair_features, relative

DRAWS = 16
"""Draws among which the true place is to be found in training."""

CLOSE = (0.01, 0.05, 0.25)
"""Metres: the scales on which gaps to objects are told."""

FINE = (4.5, 13.0)
"""Radians a metre of the waves in which offsets are told: a girder passes half a metre beside the middle of a table."""

SEEN_FEATURES = PAIR_FEATURES + 4 + len(CLOSE) + 4 * len(FINE)


class PlaceCritic(nn.Module):
    """Scores S places of each of B targets among M tokens, of which the network's ``view`` (B, M, V) is given."""

    def __init__(self, view: int, width: int = 64) -> None:
        super().__init__()
        self.view = nn.Linear(view, width)
        self.seen = nn.Linear(SEEN_FEATURES, width)
        self.each = nn.Sequential(nn.GELU(), nn.Linear(width, width), nn.GELU())
        self.out = nn.Sequential(nn.Linear(2 * width, width), nn.GELU(), nn.Linear(width, 1))

    def forward(
        self, view: Tensor, box: Tensor, mask: Tensor, scale: Tensor, target_half: Tensor, bottom: Tensor, place: Tensor
    ) -> Tensor:
        """Log ratios (B, S) up to a constant for each target.

        Parameters
        ----------
        view, box, mask, scale
            (B, M, V), (B, M, 8), (B, M) and (B, 1), see :meth:`.network.AnchorModel.places`.
        target_half, bottom
            (B, 3) and (B,), metres.
        place
            (B, S, 3): x and y, metres, and heading, radians, in the world.
        """
        seen = _seen_from(box, _boxes_at(place, target_half, bottom), scale)
        hidden, there = self.each(self.view(view).unsqueeze(2) + self.seen(seen)), mask[:, :, None, None]
        pooled = torch.cat([(hidden * there).sum(1) / 8, (hidden + (there - 1) * 1e4).amax(1)], dim=-1)
        return self.out(pooled).squeeze(-1)


def _boxes_at(place: Tensor, half: Tensor, bottom: Tensor) -> Tensor:
    """The target's boxes (B, S, 8) at places (B, S, 3)."""
    height = (bottom + half[:, 2])[:, None, None].expand(-1, place.shape[1], -1)
    size = half.unsqueeze(1).expand(-1, place.shape[1], -1)
    return torch.cat([place[..., :2], height, size, place[..., 2:].cos(), place[..., 2:].sin()], dim=-1)


def _seen_from(box: Tensor, target: Tensor, scale: Tensor) -> Tensor:
    """How targets (B, S, 8) lie in the frames of tokens (B, M, 8), and these in theirs, (B, M, S, SEEN_FEATURES)."""
    there = pair_features(box, scale, target)
    x, y, _, _, gap_x, gap_y = (part.transpose(1, 2) for part in relative(target, box))
    own = torch.stack([x / 3, y / 3, gap_x.clamp(-3, 6), gap_y.clamp(-3, 6)], dim=-1)
    gap = torch.maximum(there[..., -6:-4].amax(-1), own[..., 2:].amax(-1))
    close = torch.stack([torch.tanh(gap / metres) for metres in CLOSE], dim=-1)
    offset = 3 * there[..., :2]
    fine = [wave(rate * offset) for rate in FINE for wave in (torch.sin, torch.cos)]
    return torch.cat([there, own, close, *fine], dim=-1)


@torch.no_grad()
def drawn(mixture: tuple[Tensor, ...], box: Tensor, draws: int = DRAWS) -> Tensor:
    """Places (B, draws, 3) from a mixture over places of each token, as when generating.

    Within :data:`TAIL` standard deviations; headings by their normal approximation.
    """
    weight, mean, sigma, heading, kappa = mixture
    part = torch.multinomial(weight.exp(), draws, replacement=True)
    pair = part.unsqueeze(-1).expand(-1, -1, 2)
    edge = math.erf(TAIL / math.sqrt(2)) * (1 - 1e-6)
    normal = math.sqrt(2) * torch.special.erfinv((2 * torch.rand(pair.shape, device=box.device) - 1) * edge)
    along, across = (normal * sigma.gather(1, pair)).unbind(-1)
    token = (part // (weight.shape[1] // box.shape[1])).unsqueeze(-1).expand(-1, -1, 2)
    cos, sin = box[..., 6:].gather(1, token).unbind(-1)
    offset = torch.stack([cos * along - sin * across, sin * along + cos * across], dim=-1)
    turn = heading.gather(1, part) + torch.randn(part.shape, device=box.device) / kappa.gather(1, part).sqrt()
    return torch.cat([mean.gather(1, pair) + offset, turn.unsqueeze(-1)], dim=-1)
