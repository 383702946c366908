"""The same small network over the objects of a room, with more or less of the symmetry of space built in.

Every object sees its nearest others; what differs is in which numbers it sees where they are. All give the same: a
vector for each object, and numbers for each pair, which no network but the plain one changes when the room turns.
"""

from __future__ import annotations

from collections.abc import Callable

import torch
from torch import Tensor, nn

from ...poses import FORMS
from ..algebra import EquivariantLinear, MotionBlock, embed_frame, invariant_parts
from ..algebra.pga_products import GEOMETRIC, JOIN, METRIC, REVERSED
from .room_tensors import RoomBatch

ROUNDS = 2
"""How often objects look at each other."""

FINE = 10.0
"""What is told of a pair is told twice, as it is and as tanh(10 a): a support ends within centimetres."""

POINTS, CHANNELS = 4, 4


def told_twice(x: Tensor) -> Tensor:
    """Numbers (..., A) as (..., 2 A), see :data:`FINE`."""
    return torch.cat([x, torch.tanh(FINE * x)], dim=-1)


def _perceptron(inputs: int, hidden: int, outputs: int) -> nn.Sequential:
    return nn.Sequential(nn.Linear(inputs, hidden), nn.GELU(), nn.Linear(hidden, outputs))


class MessageNetwork(nn.Module):
    """Messages from neighbours, averaged: h_i + f(h_i, mean over j of g(h_i, h_j, a_ij)).

    Source: Gilmer et al., "Neural message passing for quantum chemistry", 2017. A subclass says what a_ij is.
    """

    own, pair = 6, 0
    """How many numbers it is told of an object, and of a pair."""

    frames = True
    """Whether places are proposed in the frames of objects; else in the world's."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.width = width
        self.first = _perceptron(self.own, width, width)
        self.message = nn.ModuleList(_perceptron(2 * width + self.pair, width, width) for _ in range(ROUNDS))
        self.update = nn.ModuleList(_perceptron(2 * width, width, width) for _ in range(ROUNDS))

    @property
    def pair_width(self) -> int:
        """How many numbers a pair has when all is done."""
        return self.pair

    def told(self, batch: RoomBatch) -> tuple[Tensor, Tensor]:
        """Numbers of objects (N, own), and of pairs (N, K, pair)."""
        return batch.size, batch.pose.new_zeros(*batch.near.shape, 0)

    def forward(self, batch: RoomBatch) -> tuple[Tensor, Tensor]:
        """Vectors of objects (N, width) and numbers of pairs (N, K, pair_width)."""
        own, pair = self.told(batch)
        hidden = self.first(own)
        for message, update in zip(self.message, self.update, strict=True):
            sent = message(self.pairs(hidden, batch, pair))
            hidden = hidden + update(torch.cat([hidden, averaged(sent, batch.seen)], dim=-1))
        return hidden, pair

    @staticmethod
    def pairs(hidden: Tensor, batch: RoomBatch, pair: Tensor) -> Tensor:
        """Each object beside each of its neighbours, (N, K, 2 width + pair)."""
        mine = hidden.unsqueeze(1).expand(-1, batch.near.shape[1], -1)
        return torch.cat([mine, hidden[batch.near], pair], dim=-1)


def averaged(sent: Tensor, seen: Tensor) -> Tensor:
    """Means (N, C) of messages (N, K, C) over those that are there."""
    there = seen.unsqueeze(-1).to(sent)
    return (sent * there).sum(1) / there.sum(1).clamp(min=1)


class AbsoluteNetwork(MessageNetwork):
    """Told where each object stands in the world, as 6D: nothing of symmetry."""

    own, frames = 6 + 9, False

    def told(self, batch: RoomBatch) -> tuple[Tensor, Tensor]:
        """The pose of each object, metres by three; nothing of pairs."""
        pose = FORMS["sixd"].encode(batch.pose)
        own = torch.cat([batch.size, pose[..., :3] / 3, pose[..., 3:]], dim=-1)
        return own, pose.new_zeros(*batch.near.shape, 0)


class RelativeNetwork(MessageNetwork):
    """Told the neighbour's pose in the object's own frame, as 6D, and where up is in it."""

    own, pair = 6 + 3, 2 * 9

    def told(self, batch: RoomBatch) -> tuple[Tensor, Tensor]:
        """Where up is, and the relative poses."""
        back = batch.pose[:, :3, :3].transpose(1, 2).unsqueeze(1)
        other = batch.pose[batch.near]
        turn = back @ other[..., :3, :3]
        shift = (back @ (other[..., :3, 3:] - batch.pose[:, None, :3, 3:])).squeeze(-1)
        pair = torch.cat([shift, turn[..., 0], turn[..., 1]], dim=-1)
        return torch.cat([batch.size, batch.pose[:, 2, :3]], dim=-1), told_twice(pair)


class DistanceNetwork(MessageNetwork):
    """Told distances only, and moving its own points: E(n)-equivariant (Satorras et al. 2021, equations 3 to 6).

    An object is four points, its middle and the ends of its axes, one metre long: turned objects differ.
    """

    pair = 2 * POINTS**2

    def __init__(self, width: int) -> None:
        super().__init__(width)
        self.step = nn.ModuleList(nn.Linear(width, POINTS) for _ in range(ROUNDS))

    def forward(self, batch: RoomBatch) -> tuple[Tensor, Tensor]:
        """As :class:`MessageNetwork`; the numbers of pairs are the distances at the end."""
        middle = batch.pose[:, None, :3, 3]
        points = torch.cat([middle, middle + batch.pose[:, :3, :3].transpose(1, 2)], dim=1)
        hidden = self.first(batch.size)
        for message, update, step in zip(self.message, self.update, self.step, strict=True):
            pair = _distances(points, batch.near)
            sent = message(self.pairs(hidden, batch, pair))
            away = points[:, None] - points[batch.near]
            points = points + averaged((away * step(sent).tanh().unsqueeze(-1)).flatten(2), batch.seen).unflatten(
                1, (POINTS, 3)
            )
            hidden = hidden + update(torch.cat([hidden, averaged(sent, batch.seen)], dim=-1))
        return hidden, _distances(points, batch.near)


def _distances(points: Tensor, near: Tensor) -> Tensor:
    """How far the points (N, 4, 3) of each object are from those of its neighbours, told twice, (N, K, 32)."""
    apart = points[:, None, :, None] - points[near][:, :, None]
    return told_twice((apart.square().sum(-1) + 1e-6).sqrt().flatten(2))


class MotionNetwork(nn.Module):
    """Multivectors that attend to each other: GATr's blocks, equivariant under all motions.

    Poses come in as a point and three planes. Numbers of a pair are what no motion changes of products and joins.
    """

    symmetry, frames = "motions", True
    """The symmetry of the first layer, of the last one, and of what is told of pairs."""

    forms: Tensor

    def __init__(self, width: int) -> None:
        super().__init__()
        self.width = width
        self.first = EquivariantLinear(POINTS, CHANNELS, 6, width, self.symmetry)
        self.blocks = nn.ModuleList(MotionBlock(CHANNELS, width) for _ in range(ROUNDS))
        self.last = EquivariantLinear(CHANNELS, 2 * CHANNELS, width, width, self.symmetry)
        self.register_buffer("forms", invariant_forms(self.symmetry), False)

    @property
    def pair_width(self) -> int:
        """How many numbers a pair has when all is done."""
        return 2 * (self.forms.shape[-1] - len(SEEN) + 1) * CHANNELS

    def forward(self, batch: RoomBatch) -> tuple[Tensor, Tensor]:
        """As :class:`MessageNetwork`."""
        x, hidden = self.first(embed_frame(batch.pose), batch.size)
        for block in self.blocks:
            x, hidden = block(x, hidden, batch.seen, batch.near)
        asked, hidden = self.last(x, hidden)
        query, key = asked.split(CHANNELS, dim=-2)
        return hidden, self._unchanged(query, key[batch.near])

    def _unchanged(self, x: Tensor, y: Tensor) -> Tensor:
        """Numbers (N, K, pair_width) of pairs of multivectors (N, C, 16) and (N, K, C, 16)."""
        by_left = (x @ self.forms.flatten(1)).unflatten(-1, self.forms.shape[1:])
        found = (y.transpose(1, 2) @ by_left).transpose(1, 2)
        parts, line = found.split([found.shape[-1] - len(SEEN), len(SEEN)], dim=-1)
        length = (line.square().sum(-1, keepdim=True) + 1e-6).sqrt()
        return told_twice(torch.cat([parts, length], dim=-1).flatten(-2))


SEEN = tuple(METRIC.nonzero().flatten().tolist())
"""The coefficients of a join whose squares are its squared length."""


def invariant_forms(symmetry: str) -> Tensor:
    """Bilinear forms (16, 16, F): of x ~y and of the join what no motion changes, then the join where it has a length.

    Only these numbers are needed of the products of all pairs, so the products are never made.
    """
    parts = torch.tensor(invariant_parts(symmetry), dtype=torch.float32, device="cpu").T
    product = GEOMETRIC * REVERSED[:, None]
    return torch.cat([product @ parts, JOIN @ parts, JOIN[..., list(SEEN)]], dim=-1)


class UprightNetwork(MotionNetwork):
    """The same with the symmetry that rooms have: turns about the vertical and shifts. It knows where up is.

    The first layer puts the vertical direction beside the objects, the last one tells heights from widths; between
    them blocks that commute with all motions are enough, and have fewer weights.
    """

    symmetry = "rooms"


NETWORKS: dict[str, Callable[[int], nn.Module]] = {
    "absolute": AbsoluteNetwork,
    "absolute, turned": AbsoluteNetwork,
    "relative": RelativeNetwork,
    "EGNN": DistanceNetwork,
    "PGA": MotionNetwork,
    "PGA, upright": UprightNetwork,
}
"""By name; "absolute, turned" is trained on rooms that are turned anew in every step."""

AUGMENTED = ("absolute, turned",)
