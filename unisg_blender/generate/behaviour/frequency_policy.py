"""Actions by simple rules: what is usual for the category, with the nearest object of the usual category."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Floats
from .action_kinds import Kind, Kinds
from .action_policy import ActionChoice, Scores
from .observation import BehaviourObservation
from .roled_actions import SLOTS

FAR = 1e3
"""What an unusual category loses, metres: more than any room is wide."""


class FrequencyPolicy:
    """What most objects of the category have: the commonest other category, and the nearest object of it.

    An action is wanted for a new object by the share of the training objects of its category that have that role in
    an action of the kind, whatever the lesson has already.
    """

    def __init__(self, kinds: Kinds) -> None:
        self.kinds = kinds
        number = {name: position for position, name in enumerate(kinds.categories)}
        shape = len(kinds.kinds), 3, len(kinds.categories) + 1
        self.share, self.usual = np.zeros(shape), np.full(shape, -FAR)
        for row, kind in enumerate(kinds.kinds):
            for slot, name in enumerate(SLOTS):
                most = max(kind.slots[slot].values(), default=0)
                for category, count in kind.slots[slot].items():
                    self.share[row, slot, number[category]] = kind.roles.get(f"{name}|{category}", 0.0)
                    self.usual[row, slot, number[category]] = 0.0 if count == most else -FAR * (1 - count / most)

    def scores(self, observed: BehaviourObservation) -> Scores:
        """Probabilities of kinds, and closeness of those that may take part in them."""
        usual = self.usual[:, :, observed.category]
        near = -np.linalg.norm(observed.position[:, None] - observed.position[None], axis=2)
        tool, frame = (usual[:, slot, None, :] + near for slot in (1, 2))
        return Scores(self._wanted(observed), usual[:, 0], tool, frame)

    def _wanted(self, observed: BehaviourObservation) -> Floats:
        """The largest share (K,) that speaks for an action with a new object that has none of the kind yet."""
        share = self.share[:, :, observed.category] * observed.new
        action, slot = np.nonzero((observed.slots >= 0) & (observed.kind >= 0)[:, None])
        share[observed.kind[action], slot, observed.slots[action, slot]] = 0.0
        return share.max(axis=(1, 2), initial=0.0)

    def after(self, observed: BehaviourObservation, choice: ActionChoice) -> int:
        """The last action of the stage that usually comes before; -1 if none does."""
        wanted = self.kinds.kinds[choice.kind]
        stage = self.kinds.stage_number.get(wanted.stage, -1)
        inside = np.flatnonzero((observed.leaf_stage == stage) & (observed.leaf_order >= 0) & (observed.kind >= 0))
        earlier = [
            action for action in inside.tolist() if _rank(self.kinds.kinds[observed.kind[action]]) < _rank(wanted)
        ]
        return max(earlier, key=lambda action: observed.leaf_order[action], default=-1)


class LackingPolicy(FrequencyPolicy):
    """What the lesson lacks: kinds that most rooms with these objects have, with objects that take part in it already,
    else of the commonest category, else the nearest."""

    def scores(self, observed: BehaviourObservation) -> Scores:
        """As before, with objects that are busy already first."""
        scores = super().scores(observed)
        busy = np.zeros(len(observed.rows))
        busy[observed.slots[:, :2][observed.slots[:, :2] >= 0]] = FAR / 10
        return Scores(scores.wanted, scores.target + busy, scores.tool + busy, scores.frame)

    def _wanted(self, observed: BehaviourObservation) -> Floats:
        """A kind is wanted while the scene has fewer actions of it than training scenes had."""
        there = np.bincount(observed.kind[observed.kind >= 0], minlength=len(self.kinds.kinds))
        return np.array([kind.chance * (there[n] < kind.most) for n, kind in enumerate(self.kinds.kinds)])


def _rank(kind: Kind) -> tuple[float, str]:
    return kind.rank, kind.name
