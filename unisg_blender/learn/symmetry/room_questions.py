"""What the networks are asked about rooms, by what they see of them: heads, losses, and how answers are judged."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from ...metrics.edge_metrics import average_precision
from .room_tensors import RoomBatch
from .symmetry_networks import MessageNetwork

COMPONENTS = 2
"""Places that each object proposes."""

LEAST, NLL_LIMIT = 0.02, 20.0
"""The least spread of a proposed place, metres, and the most nats that one room may count."""


class Question(nn.Module):
    """A network over rooms with a perceptron that turns what it saw into answers.

    ``per`` says what has an answer: a "pair", an "object", a "room", or a "place" for one more object.
    """

    def __init__(self, network: nn.Module, per: str, classes: int) -> None:
        super().__init__()
        self.network, self.per = network, per
        width = int(network.width)  # type: ignore[arg-type]
        inputs = {"pair": 2 * width + int(network.pair_width), "place": width + 6}.get(per, width)  # type: ignore[arg-type]
        outputs = 9 * COMPONENTS if per == "place" else classes
        self.head = nn.Sequential(nn.Linear(inputs, width), nn.GELU(), nn.Linear(width, outputs))

    def forward(self, batch: RoomBatch) -> Tensor:
        """Answers: logits (N, NEAREST), (N,) or (K, classes), or the nats (K,) that true places cost."""
        hidden, pair = self.network(batch)
        if self.per == "pair":
            return self.head(MessageNetwork.pairs(hidden, batch, pair)).squeeze(-1)
        if self.per == "object":
            return self.head(hidden).squeeze(-1)
        there = batch.there.unsqueeze(-1).to(hidden)
        if self.per == "room":
            mean = (hidden[batch.rows] * there).sum(1) / there.sum(1)
            return self.head(mean)
        wanted = batch.size[batch.truth].unsqueeze(1).expand(-1, batch.rows.shape[1], -1)
        mixture = self.head(torch.cat([hidden[batch.rows], wanted], dim=-1)).unflatten(-1, (COMPONENTS, 9))
        return place_nll(mixture, batch, bool(self.network.frames))

    def loss(self, batch: RoomBatch, answers: Tensor) -> Tensor:
        """What is minimised."""
        if self.per == "place":
            return answers.clamp(max=NLL_LIMIT).mean()
        if self.per == "room":
            return nn.functional.cross_entropy(answers, batch.truth)
        kept = batch.seen if self.per == "pair" else torch.ones_like(batch.truth)
        return nn.functional.binary_cross_entropy_with_logits(answers[kept], batch.truth[kept].to(answers))


def place_nll(mixture: Tensor, batch: RoomBatch, frames: bool) -> Tensor:
    """Nats (K,) that the poses of the objects asked for cost under mixtures (K, T, COMPONENTS, 9).

    A component is a logit, a mean and the logarithms of spreads, metres along the axes of its object's frame (or of the
    world's), and a von Mises distribution of the heading by its mean direction times its concentration.
    """
    frame = (
        batch.pose[batch.rows]
        if frames
        else torch.eye(4, dtype=batch.pose.dtype, device=batch.pose.device).expand(*batch.rows.shape, 4, 4)
    )
    target, back = batch.pose[batch.truth].unsqueeze(1), frame[..., :3, :3].transpose(-1, -2)
    place = (back @ (target[..., :3, 3:] - frame[..., :3, 3:])).squeeze(-1).unsqueeze(2)
    turn = back @ target[..., :3, :3]
    angle = torch.atan2(turn[..., 1, 0] - turn[..., 0, 1], turn[..., 0, 0] + turn[..., 1, 1]).unsqueeze(2)
    logit, mean, spread, toward = mixture.split([1, 3, 3, 2], dim=-1)
    sigma = spread.clamp(-6, 3).exp() + LEAST
    normal = -0.5 * ((place - mean) / sigma).square() - sigma.log() - 0.5 * math.log(2 * math.pi)
    kappa = (toward.square().sum(-1) + 1e-6).sqrt()
    mises = toward[..., 0] * angle.cos() + toward[..., 1] * angle.sin()
    mises = mises - torch.special.i0e(kappa).log() - kappa - math.log(2 * math.pi)
    weight = torch.where(batch.there.unsqueeze(-1), logit.squeeze(-1), logit.new_tensor(-1e9))
    weight = weight.flatten(1).log_softmax(-1)
    return -torch.logsumexp(weight + (normal.sum(-1) + mises).flatten(1), dim=-1)


def error_of(per: str, answers: Tensor, truth: Tensor) -> float:
    """How wrong answers are: 1 - average precision of pairs and objects, share of rooms, or mean nats of places."""
    if per == "place":
        return float(answers.clamp(max=NLL_LIMIT).mean())
    if per == "room":
        return float((answers.argmax(1) != truth).float().mean())
    return 1.0 - average_precision(answers.numpy(), truth.numpy())


@dataclass(frozen=True)
class RoomTask:
    """A task: what has an answer, of how many classes; in "own", "moved" (things are displaced) or "foreign" rooms."""

    per: str
    classes: int = 1
    rooms: str = "own"
    also_foreign: bool = False


TASKS = {
    "supports": RoomTask("pair", also_foreign=True),
    "kinds": RoomTask("room", 2),
    "foreign kinds": RoomTask("room", 3, "foreign"),
    "critic": RoomTask("object", rooms="moved"),
    "completion": RoomTask("place"),
    "behaviour": RoomTask("object"),
}
"""Which object stands on which neighbour; which kind of room it is, of ours and of others'; which objects were moved
from where they belong; where one more object of a size stands; with which objects something is to be done."""
