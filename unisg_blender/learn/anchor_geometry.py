"""Geometry that the anchor model is built on: pairs of things, base places in their frames, and room around places."""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
from torch import Tensor

PLACES, TURNS = 12, 4
PAIR_FEATURES = 28
TOUCHING = 0.002
"""Metres: things that are equally high, or overlap, by less do not meet."""

BEHIND = 1.5
"""Metres behind a wall that count as out of the room, for what no wall holds."""

FREE = -10.0
"""Metres: how deep everything is in what is no obstacle."""


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


def solid_boxes(box: Tensor, flags: Tensor) -> Tensor:
    """The tokens' boxes (B, M, 8); walls with :data:`BEHIND` metres behind them, unless a wall holds the target."""
    inner = flags[..., 4]
    held_by_wall = (inner.abs() * flags[..., 0]).sum(1, keepdim=True) > 0
    back = torch.where(held_by_wall, torch.zeros_like(inner), inner) * (BEHIND / 2)
    x, y, z, long, thick, tall, cos, sin = box.unbind(-1)
    return torch.stack([x + sin * back, y - cos * back, z, long, thick + back.abs(), tall, cos, sin], dim=-1)


def obstacles(
    box: Tensor, flags: Tensor, mask: Tensor, target_half: Tensor, bottom: Tensor, tolerance: Tensor
) -> Tensor:
    """What is added to the depth in each token (B, M): minus the ``tolerance``, or :data:`FREE` for no obstacle.

    Obstacles are as high as the target and do not hold it.
    """
    low, high = box[..., 2] - box[..., 5], box[..., 2] + box[..., 5]
    top = bottom + 2 * target_half[:, 2]
    level = torch.minimum(high, top.unsqueeze(1)) - torch.maximum(low, bottom.unsqueeze(1))
    stands = (level > TOUCHING) & (flags[..., 0] + flags[..., 2] == 0) & (mask > 0)
    return torch.where(stands, -tolerance, FREE)


@torch.no_grad()
def clearances(
    box: Tensor, flags: Tensor, mask: Tensor, target_half: Tensor, bottom: Tensor, tolerance: Tensor, x: Tensor,
    y: Tensor,
) -> tuple[Tensor, Tensor, Tensor, Tensor]:  # fmt: skip
    """How deep the target at places (B, M, 48) in the tokens' frames reaches into others, and out of its support.

    Metres, negative where it is clear, by separating axes of the boxes' footprints, with the
    target's ``bottom`` (B,), beyond the ``tolerance`` (B, M) that is usual, see
    :func:`obstacles`. Then how far it can go along x and along y to the
    nearest of those that it does not meet, at most 10 m.
    """
    p, q = _turned_half(target_half)
    blocked = obstacles(box, flags, mask, target_half, bottom, tolerance)[:, None, None, :]
    solid = solid_boxes(box, flags)
    cos, sin = box[:, :, None, 6], box[:, :, None, 7]
    offset = solid[:, None, :, :2] - box[:, :, None, :2]
    far_x, far_y = cos * offset[..., 0] + sin * offset[..., 1], cos * offset[..., 1] - sin * offset[..., 0]
    wide, deep = _extents(box, solid)
    to_x, to_y = x.unsqueeze(-1) - far_x.unsqueeze(2), y.unsqueeze(-1) - far_y.unsqueeze(2)
    into_x = (p + wide.unsqueeze(2)) - to_x.abs() + blocked
    into_y = (q + deep.unsqueeze(2)) - to_y.abs() + blocked
    turn_cos = (cos * box[:, None, :, 6] + sin * box[:, None, :, 7]).unsqueeze(2)
    turn_sin = (cos * box[:, None, :, 7] - sin * box[:, None, :, 6]).unsqueeze(2)
    own_x = solid[:, None, None, :, 3] + p * turn_cos.abs() + q * turn_sin.abs()
    own_y = solid[:, None, None, :, 4] + p * turn_sin.abs() + q * turn_cos.abs()
    into_own = torch.minimum(own_x - (turn_cos * to_x + turn_sin * to_y).abs(),
                             own_y - (turn_cos * to_y - turn_sin * to_x).abs()) + blocked  # fmt: skip
    meets = torch.minimum(torch.minimum(into_x, into_y), into_own).amax(-1)
    room_x = -torch.where((into_y > TOUCHING) & (into_x <= 0), into_x, FREE).amax(-1)
    room_y = -torch.where((into_x > TOUCHING) & (into_y <= 0), into_y, FREE).amax(-1)
    support = (flags[..., 0] * (flags[..., 5] > 0)).unsqueeze(1)  # what stands on a root may stand anywhere
    out_x = (x - (far_x * support).sum(-1, keepdim=True)).abs() + p[..., 0] - (wide * support).sum(-1, keepdim=True)
    out_y = (y - (far_y * support).sum(-1, keepdim=True)).abs() + q[..., 0] - (deep * support).sum(-1, keepdim=True)
    leaves = torch.maximum(out_x, out_y) * support.sum(-1, keepdim=True)
    return meets.clamp(-1, 1), leaves.clamp(-1, 1), room_x, room_y


def _turned_half(target_half: Tensor) -> tuple[Tensor, Tensor]:
    """Half extents along x and y (B, 1, 48, 1) of a target turned by each component's quarters."""
    turned = (torch.arange(TURNS).repeat(PLACES) % 2 == 1).to(target_half.dtype)
    p = target_half[:, 0, None] * (1 - turned) + target_half[:, 1, None] * turned
    q = target_half[:, 1, None] * (1 - turned) + target_half[:, 0, None] * turned
    return p[:, None, :, None], q[:, None, :, None]


def _extents(box: Tensor, solid: Tensor) -> tuple[Tensor, Tensor]:
    """Half extents (B, M, M) of the solid box of token j along the axes of token i."""
    cos, sin = box[:, :, None, 6], box[:, :, None, 7]
    turn_cos = (cos * box[:, None, :, 6] + sin * box[:, None, :, 7]).abs()
    turn_sin = (cos * box[:, None, :, 7] - sin * box[:, None, :, 6]).abs()
    wide = turn_cos * solid[:, None, :, 3] + turn_sin * solid[:, None, :, 4]
    return wide, turn_sin * solid[:, None, :, 3] + turn_cos * solid[:, None, :, 4]


def base_places(box: Tensor, flags: Tensor, target_half: Tensor, bottom: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Base places in each token's frame, x and y (B, M, 48) metres, and their headings (48,) radians.

    Component ``p * 4 + t`` is place p with the target turned t quarters. Neighbours
    have the target flush to a side, at either end or in the middle; the support, and
    what is wholly above or below a target with this ``bottom`` (B,), has
    it in a 3 x 3 grid on itself and between; walls along their inner side, touching
    or half a metre off.
    """
    a, b = box[..., 3, None], box[..., 4, None]
    quarter = torch.arange(TURNS).repeat(PLACES)
    p, q = (reach[..., 0] for reach in _turned_half(target_half))

    def row(values: Sequence[float]) -> Tensor:
        return torch.tensor(values).repeat_interleave(TURNS)

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
