"""The network of behaviour: objects and actions as nodes of a graph; which action comes next, and who plays in it.

Objects (category, whether something is wanted for them, how they are held) and the
actions that there are (kind, stage, place) exchange messages along who plays what
in which action, who holds whom, and among objects of one category. For each kind
of action the network then says whether one more is to be made, points to its
target, from there to its tool and frame, and to the leaf behind which it goes.
Nothing depends on the order of objects or actions, and only distances between
objects count, so that moving or turning the room changes nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor, nn

RELATIONS = 4
PAIR_FEATURES = 6
FAR = -1e4


@dataclass(frozen=True)
class BehaviourSizes:
    """Number of known categories, kinds and stages, and the widths of the layers."""

    categories: int
    kinds: int
    stages: int
    embedding: int = 24
    width: int = 48
    layers: int = 2


class Seen(NamedTuple):
    """Objects (B, E, width) and actions (B, A, width) after all messages, who may play what (B, K, 3, E), and the
    logits (B, K) of one more action."""

    objects: Tensor
    roled: Tensor
    able: Tensor
    wanted: Tensor


class BehaviourNet(nn.Module):
    """:meth:`forward` is what the exported model computes.

    ``allowed`` bool (K, 3, C + 1) says which categories may play target, tool and frame of each kind; where a kind
    has no such part, none.
    """

    allowed: Tensor

    def __init__(self, sizes: BehaviourSizes, allowed: Tensor) -> None:
        super().__init__()
        self.sizes = sizes
        self.register_buffer("allowed", allowed.float())
        width, embedding = sizes.width, sizes.embedding
        self.category = nn.Embedding(sizes.categories + 1, embedding)
        self.kind = nn.Embedding(sizes.kinds + 1, embedding)
        self.stage = nn.Embedding(sizes.stages + 1, embedding)
        self.obj = nn.Linear(embedding + 1 + RELATIONS, width)
        self.roled_action = nn.Linear(2 * embedding + 1, width)
        self.layers = nn.ModuleList(_Exchange(width) for _ in range(sizes.layers))
        self.query = nn.Linear(embedding, 4 * width)
        self.pair = nn.Linear(embedding, 2 * PAIR_FEATURES)
        self.begin = nn.Linear(embedding, width)
        self.wanted = nn.Sequential(nn.Linear(embedding + 2 * width + 4, width), nn.GELU(), nn.Linear(width, 1))

    def forward(self, **inputs: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor, Tensor]:
        """Scores for B scenes of E objects and A actions.

        Parameters
        ----------
        inputs
            :data:`...generate.behaviour.network_policy.INPUTS`: category, new, relation, holds, place, mask: int64
            (B, E), (B, E), int64 (B, E), (B, E, E) 1 where the second object holds the first, (B, E, 3) metres, (B, E);
            kind, stage, order, plays, act_mask: int64 (B, A), int64 (B, A), (B, A) place of the leaf in its stage
            (negative for none), (B, A, 3, E) 1 where the object is the action's target, tool or frame, (B, A).

        Returns
        -------
        Logits (B, K) of one more action of each kind; log probabilities of targets (B, K, E), of tools
        and frames (B, K, E, E) by target; scores (B, K, A + S) of the leaf, or beginning of a stage, that it follows.
        """
        seen = self.encode(inputs)
        every = torch.arange(self.sizes.kinds, device=seen.objects.device)
        features = _pair_features(inputs["place"], inputs["holds"]).unsqueeze(1)
        tool, frame = (
            _log_softmax(
                (self.asked(slot)[every] @ seen.objects.transpose(1, 2)).unsqueeze(2)
                + (features * self.pair_weights(slot)[every].view(1, -1, 1, 1, PAIR_FEATURES)).sum(-1),
                seen.able[:, :, slot].unsqueeze(2),
            )
            for slot in (1, 2)
        )
        return seen.wanted, self.targets(seen), tool, frame, self.followed(seen.roled)

    def encode(self, inputs: Mapping[str, Tensor]) -> Seen:
        """Objects and actions after all messages; inputs by name, as of :meth:`forward`."""
        category, new, mask, act_mask = (inputs[name] for name in ("category", "new", "mask", "act_mask"))
        one_hot = nn.functional.one_hot(inputs["relation"], RELATIONS).float()
        objects = self.obj(torch.cat([self.category(category), new.unsqueeze(-1), one_hot], -1)) * mask.unsqueeze(-1)
        last = (inputs["order"] / 8).clamp(-1, 4).unsqueeze(-1)
        of_action = [self.kind(inputs["kind"]), self.stage(inputs["stage"]), last]
        roled = self.roled_action(torch.cat(of_action, -1)) * act_mask.unsqueeze(-1)
        same = (category.unsqueeze(2) == category.unsqueeze(1)).float() * mask.unsqueeze(1)
        for layer in self.layers:
            objects, roled = layer(objects, roled, inputs["plays"], inputs["holds"], same, mask, act_mask)
        able = self.allowed[:, :, category].permute(2, 0, 1, 3) * mask[:, None, None]
        return Seen(objects, roled, able, self._wanted(objects, new, able, inputs["kind"], act_mask))

    def asked(self, slot: int) -> Tensor:
        """What each kind looks for in its target (0), tool (1), frame (2) and in the leaf before it (3), (K, width)."""
        return self.query(self.kind.weight[:-1]).chunk(4, dim=-1)[slot] / self.sizes.width**0.5

    def pair_weights(self, slot: int) -> Tensor:
        """What closeness to the target means for each kind's tool (1) or frame (2), (K, PAIR_FEATURES)."""
        return self.pair(self.kind.weight[:-1]).chunk(2, dim=-1)[slot - 1]

    def targets(self, seen: Seen) -> Tensor:
        """Log probabilities (B, K, E)."""
        return _log_softmax(self.asked(0) @ seen.objects.transpose(1, 2), seen.able[:, :, 0])

    def partners(self, seen: Seen, place: Tensor, holds: Tensor, rows: Tensor, slot: int) -> Tensor:
        """Log probabilities (M, E) of tools (1) or frames (2) for ``rows`` (M, 3): scene, kind and target."""
        scene, kind, target = rows.unbind(1)
        features = _pair_features(place, holds)[scene, target]
        base = (self.asked(slot)[kind].unsqueeze(1) @ seen.objects[scene].transpose(1, 2)).squeeze(1)
        apart = (features * self.pair_weights(slot)[kind].unsqueeze(1)).sum(-1)
        return _log_softmax(base + apart, seen.able[scene, kind, slot])

    def followed(self, roled: Tensor) -> Tensor:
        """Scores (B, K, A + S) of the leaf of an act, or beginning of a stage, that a kind's new leaf follows."""
        starts = self.begin(self.stage.weight[:-1]).expand(len(roled), -1, -1)
        return self.asked(3) @ torch.cat([roled, starts], 1).transpose(1, 2)

    def _wanted(self, objects: Tensor, new: Tensor, able: Tensor, kind: Tensor, act_mask: Tensor) -> Tensor:
        """From what is new and may play in the kind, all that may, and how many actions of the kind there are."""
        kinds = self.kind.weight[:-1]
        some = able.amax(2)
        fresh = some * new.unsqueeze(1)
        number = torch.arange(len(kinds), device=kind.device).view(1, -1, 1)
        there = ((kind.unsqueeze(1) == number).float() * act_mask.unsqueeze(1)).sum(-1)
        pooled = [weight @ objects / weight.sum(-1, keepdim=True).clamp(min=1) for weight in (fresh, some)]
        counts = torch.stack([there.clamp(max=8), (there > 0).float(), fresh.sum(-1).log1p(), some.sum(-1).log1p()], -1)
        own = kinds.expand(len(objects), -1, -1)
        return self.wanted(torch.cat([own, *pooled, counts], -1)).squeeze(-1)


class _Exchange(nn.Module):
    """One round of messages."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.to_act = nn.Linear(3 * width, width)
        self.of_act = nn.Linear(width, 3 * width)
        self.roled_action = nn.Sequential(nn.LayerNorm(2 * width), nn.Linear(2 * width, width), nn.GELU())
        self.obj = nn.Sequential(
            nn.LayerNorm(6 * width), nn.Linear(6 * width, 2 * width), nn.GELU(), nn.Linear(2 * width, width)
        )

    def forward(
        self, objects: Tensor, roled: Tensor, plays: Tensor, holds: Tensor, same: Tensor, mask: Tensor, act_mask: Tensor
    ) -> tuple[Tensor, Tensor]:
        """One round of messages between objects (B, E, W) and acts (B, A, W): both anew, of the same shapes."""
        cast = (plays @ objects.unsqueeze(1)).flatten(2)
        roled = roled + self.roled_action(torch.cat([roled, self.to_act(cast)], -1)) * act_mask.unsqueeze(-1)
        parts = self.of_act(roled).unflatten(-1, (3, -1))
        from_acts = torch.einsum("base,basw->bew", plays, parts)
        above = holds @ objects
        below = holds.transpose(1, 2) @ objects / holds.sum(1).unsqueeze(-1).clamp(min=1)
        alike = same @ objects / same.sum(-1, keepdim=True).clamp(min=1)
        room = (objects.sum(1, keepdim=True) / mask.sum(1)[:, None, None].clamp(min=1)).expand_as(objects)
        seen = torch.cat([objects, from_acts, above, below, alike, room], -1)
        return objects + self.obj(seen) * mask.unsqueeze(-1), roled


def _pair_features(place: Tensor, holds: Tensor) -> Tensor:
    """(B, E, E, PAIR_FEATURES): closeness of two objects, and who holds whom."""
    apart = ((place.unsqueeze(2) - place.unsqueeze(1)) ** 2).sum(-1).add(1e-9).sqrt()
    sisters = holds @ holds.transpose(1, 2)
    return torch.stack(
        [(-apart).exp(), (-apart / 3).exp(), (apart + 0.1).log(), holds, holds.transpose(1, 2), sisters], -1
    )


def _log_softmax(scores: Tensor, able: Tensor) -> Tensor:
    """Log probabilities among those that are able; far below all others for the rest."""
    return (scores + (able - 1) * -FAR).log_softmax(-1)
