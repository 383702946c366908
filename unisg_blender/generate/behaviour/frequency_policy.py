"""Actions by simple rules: what is usual for the category, with the nearest object of the usual category."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Floats
from .action_kinds import Kind, Kinds
from .action_policy import ActionChoice, Scores
from .observation import BehaviourObservation, distances
from .roled_actions import SLOTS

OFTEN = 0.5
"""What is seen at least this often is done."""

FAR = 1e3


class FrequencyPolicy:
    """What most objects of the category have: the commonest other category, and the nearest object of it.

    An action is made for a new object if at least half of the training objects of its category play that part in an
    action of the kind, whatever the lesson has already.
    """

    def __init__(self, kinds: Kinds) -> None:
        self.kinds = kinds
        place = {name: number for number, name in enumerate(kinds.categories)}
        shape = len(kinds.kinds), 3, len(kinds.categories) + 1
        self.share, self.usual = np.zeros(shape), np.full(shape, -FAR)
        for number, kind in enumerate(kinds.kinds):
            for slot, name in enumerate(SLOTS):
                most = max(kind.slots[slot].values(), default=0)
                for category, count in kind.slots[slot].items():
                    self.share[number, slot, place[category]] = kind.roles.get(f"{name}|{category}", 0.0)
                    self.usual[number, slot, place[category]] = 0.0 if count == most else -FAR * (1 - count / most)

    def scores(self, play: BehaviourObservation) -> Scores:
        """Probabilities of kinds, and closeness of those who may play in them."""
        plays = self.share[:, :, play.category] * play.new
        usual = self.usual[:, :, play.category]
        near = -distances(play)
        wanted = np.array([self._wanted(play, kind, plays[kind]) for kind in range(len(self.kinds.kinds))])
        tool, frame = (usual[:, slot, None, :] + near for slot in (1, 2))
        return Scores(wanted, usual[:, 0], tool, frame)

    def _wanted(self, play: BehaviourObservation, kind: int, plays: Floats) -> float:
        """The largest share that speaks for an action with a new object that has none of the kind yet."""
        busy = play.slots[play.kind == kind]
        for slot in range(3):
            there = busy[:, slot]
            plays[slot, there[there >= 0]] = 0.0
        return float(plays.max(initial=0.0))

    def after(self, play: BehaviourObservation, choice: ActionChoice) -> int:
        """The last action of the stage that usually comes before."""
        return last_before(self.kinds, play, choice.kind)


class LackingPolicy(FrequencyPolicy):
    """What the lesson lacks: kinds that most rooms with these objects have, with objects that play in it already,
    else of the commonest category, else the nearest."""

    def scores(self, play: BehaviourObservation) -> Scores:
        """As before, but a kind is wanted while the scene has fewer actions of it than training scenes had."""
        scores = super().scores(play)
        there = np.bincount(play.kind[play.kind >= 0], minlength=len(self.kinds.kinds))
        wanted = np.array([kind.chance * (there[n] < kind.most) for n, kind in enumerate(self.kinds.kinds)])
        acting = np.zeros(len(play.rows))
        used = play.slots[:, :2][play.slots[:, :2] >= 0]
        acting[used] = FAR / 10
        return Scores(wanted, scores.target + acting, scores.tool + acting, scores.frame)

    def _wanted(self, play: BehaviourObservation, kind: int, plays: Floats) -> float:
        return 0.0


def last_before(kinds: Kinds, play: BehaviourObservation, kind: int) -> int:
    """The last action of the kind's stage that comes before it by the usual places; -1 if none does."""
    wanted = kinds.kinds[kind]
    stage = kinds.stage_number.get(wanted.stage, -1)
    inside = np.flatnonzero((play.leaf_stage == stage) & (play.leaf_order >= 0) & (play.kind >= 0))
    earlier = [
        roled_action for roled_action in inside.tolist() if _rank(kinds.kinds[play.kind[roled_action]]) < _rank(wanted)
    ]
    return max(earlier, key=lambda roled_action: play.leaf_order[roled_action]) if earlier else -1


def _rank(kind: Kind) -> tuple[float, str]:
    return kind.rank, kind.name
