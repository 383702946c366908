"""Geometry that the anchor model is built on: pairs of objects and base places in their frames."""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
from torch import Tensor

PLACES, TURNS = 12, 4
PAIR_FEATURES = 28
TOUCHING = 0.002
"""Metres: objects that are equally high by less are above or below each other."""


def scale_of(box: Tensor, flags: Tensor) -> Tensor:
    """The size of the support, (B, 1): half its longer side; 1 m where there is none."""
    longest = (flags[..., 0] * box[..., 3:5].amax(-1)).sum(1, keepdim=True)
    return torch.where(longest > 0, longest, torch.ones_like(longest)).clamp(0.05, 4.0)


def relative(box: Tensor, others: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor, Tensor, Tensor]:
    """Offset x and y, cosine and sine of the turn, gaps along x and y of ``others`` in the boxes' frames, (B, M, N).

    Boxes are (B, M, 8) and (B, N, 8): centre, half extents, cosine and sine of the heading.
    """
    (dx, dy), cos, sin = (
        (others[:, None, :, :2] - box[:, :, None, :2]).unbind(-1),
        box[:, :, None, 6],
        box[:, :, None, 7],
    )
    x, y = cos * dx + sin * dy, cos * dy - sin * dx
    turn_cos = cos * others[:, None, :, 6] + sin * others[:, None, :, 7]
    turn_sin = cos * others[:, None, :, 7] - sin * others[:, None, :, 6]
    wide = turn_cos.abs() * others[:, None, :, 3] + turn_sin.abs() * others[:, None, :, 4]
    deep = turn_sin.abs() * others[:, None, :, 3] + turn_cos.abs() * others[:, None, :, 4]
    return x, y, turn_cos, turn_sin, x.abs() - box[:, :, None, 3] - wide, y.abs() - box[:, :, None, 4] - deep


def pair_features(box: Tensor, scale: Tensor, others: Tensor) -> Tensor:
    """How others lie in the boxes' frames, see :func:`relative`, plain and by the support's size: (B, M, N, 28)."""
    x, y, turn_cos, turn_sin, gap_x, gap_y = relative(box, others)
    s = scale.unsqueeze(-1)
    scaled = [(x / s).clamp(-4, 4), (y / s).clamp(-4, 4)]
    waves = [wave(f * math.pi / 2 * value) for f in (1, 2, 4) for value in scaled for wave in (torch.sin, torch.cos)]
    waves += [wave(1.5 * value) for value in (x, y) for wave in (torch.sin, torch.cos)]
    gaps = [gap_x.clamp(-3, 6), gap_y.clamp(-3, 6), (gap_x / s).clamp(-3, 4), (gap_y / s).clamp(-3, 4)]
    distance, above = (x.square() + y.square() + 1e-6).sqrt(), others[:, None, :, 2] - box[:, :, None, 2]
    return torch.stack([x / 3, y / 3, *scaled, *waves, turn_cos, turn_sin, *gaps, above, distance / 3], dim=-1)


def _turned_half(target_half: Tensor) -> tuple[Tensor, Tensor]:
    """Half extents along x and y (B, 1, 48) of a target turned by each component's quarters."""
    turned = (torch.arange(TURNS, device=target_half.device).repeat(PLACES) % 2 == 1).to(target_half.dtype)
    p = target_half[:, 0, None] * (1 - turned) + target_half[:, 1, None] * turned
    q = target_half[:, 1, None] * (1 - turned) + target_half[:, 0, None] * turned
    return p.unsqueeze(1), q.unsqueeze(1)


def base_places(box: Tensor, flags: Tensor, target_half: Tensor, bottom: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Base places in each token's frame, x and y (B, M, 48) metres, and their headings (48,) radians.

    Component ``p * 4 + t`` is place p with the target turned t quarters. Neighbours
    have the target flush to a side, at either end or in the middle; the support, and
    what is wholly above or below a target with this ``bottom`` (B,), has
    it in a 3 x 3 grid on itself and between; walls along their inner side, touching
    or half a metre off.
    """
    a, b = box[..., 3, None], box[..., 4, None]
    quarter = torch.arange(TURNS, device=box.device).repeat(PLACES)
    p, q = _turned_half(target_half)

    def row(values: Sequence[float]) -> Tensor:
        """Values by place, each for all turns, (48,)."""
        return torch.tensor(values, device=box.device).repeat_interleave(TURNS)

    along, side = row([-1, 0, 1] * 4), row([1] * 3 + [-1] * 3 + [1] * 3 + [-1] * 3)
    end = row([1.0] * 6 + [0.0] * 6)
    beside_x = end * side * (a + p) + (1 - end) * along * (a - p)
    beside_y = end * along * (b - q) + (1 - end) * side * (b + q)
    grid_x, grid_y = row([-1, -1, -1, 0, 0, 0, 1, 1, 1, -0.5, 0.5, 0]), row([-1, 0, 1, -1, 0, 1, -1, 0, 1, 0, 0, 0.5])
    on_x, on_y = grid_x * (a - p).clamp(min=0), grid_y * (b - q).clamp(min=0)
    inner = flags[..., 4, None]
    wall_x = row([-1, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1, -0.6, 0, 0.6]) * (a - p).clamp(min=0)
    wall_y = inner * (b + q + row([0.0] * 9 + [0.5] * 3))
    low, high = box[..., 2] - box[..., 5], box[..., 2] + box[..., 5]
    top = bottom + 2 * target_half[:, 2]
    clear = (torch.minimum(high, top.unsqueeze(1)) - torch.maximum(low, bottom.unsqueeze(1)) <= TOUCHING).to(box.dtype)
    wall = inner.abs()
    over = (1 - wall) * torch.maximum(flags[..., 0, None], clear.unsqueeze(-1))
    free = (1 - wall) * (1 - over)
    x = wall * wall_x + over * on_x + free * beside_x
    y = wall * wall_y + over * on_y + free * beside_y
    return x, y, quarter * (math.pi / 2)
