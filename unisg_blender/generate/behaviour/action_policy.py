"""Which action comes next: scores of kinds and roles, and the role assignments that they favour among the possible."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from .action_kinds import Kinds
from .observation import BehaviourObservation, Slots

MOST_ASSIGNMENTS = 3
"""Role assignments offered for one kind, at most."""

SURE, NEVER = 0.5, 0.1
"""Actions at least this likely are always made, those less likely than the other are never; between, a draw decides."""


@dataclass(frozen=True, eq=False)
class Scores:
    """What a policy says of a scene with E objects, for K kinds of actions.

    ``wanted`` (K,): the probability that (another) action of the kind is to be made;
    ``target`` (K, E), ``tool`` and ``frame`` (K, E, E), by target first: log probabilities or the like, to be added up.
    """

    wanted: Floats
    target: Floats
    tool: Floats
    frame: Floats


@dataclass(frozen=True)
class ActionChoice:
    """An action to make: its kind, which objects are target, tool and frame of it (-1: none), its probability."""

    kind: int
    slots: Slots
    score: float


class ActionPolicy(Protocol):
    """Says what actions are missing in a scene."""

    kinds: Kinds

    def scores(self, observed: BehaviourObservation) -> Scores:
        """The scores for the next action."""

    def after(self, observed: BehaviourObservation, choice: ActionChoice) -> int:
        """Behind which action's leaf, of the kind's stage, the new one goes; -1: it is the stage's first."""


class RoleMasks:
    """Which categories may take which role in which kind: ``allowed`` bool (K, 3, C + 1), ``used`` (K, 3)."""

    def __init__(self, kinds: Kinds) -> None:
        self.kinds = kinds
        number = {name: position for position, name in enumerate(kinds.categories)}
        self.used = np.array([[bool(names) for names in kind.slots] for kind in kinds.kinds], bool).reshape(-1, 3)
        self.allowed = np.zeros((*self.used.shape, len(kinds.categories) + 1), bool)
        for kind, slot in np.argwhere(self.used).tolist():
            self.allowed[kind, slot, [number[name] for name in kinds.kinds[kind].slots[slot] if name in number]] = True

    def candidates(self, observed: BehaviourObservation, kind: int, slot: int) -> Ints:
        """The objects that may take a role, [-1] where the kind has no such role."""
        if not self.used[kind, slot]:
            return np.array([-1])
        return np.flatnonzero(self.allowed[kind, slot, observed.category])

    def any_new(self, observed: BehaviourObservation) -> bool:
        """Whether something new may take any role."""
        return bool(observed.new.any() and self.allowed[:, :, observed.category[observed.new]].any())

    def limits(self, rng: np.random.Generator | None) -> Floats:
        """The least probability (K,) with which each kind is made: drawn, so that what is done now and then is."""
        count = len(self.kinds.kinds)
        return np.full(count, SURE) if rng is None else rng.random(count).clip(NEVER, SURE)

    def choices(self, observed: BehaviourObservation, scores: Scores, least: Floats) -> list[ActionChoice]:
        """The best assignments of the most wanted kind that has any, with at least these probabilities (K,)."""
        wanted = np.flatnonzero(scores.wanted >= least)
        ordered = wanted[np.argsort(-scores.wanted[wanted])].tolist()
        return next(filter(None, (self.assignments(observed, scores, kind) for kind in ordered)), [])

    def assignments(self, observed: BehaviourObservation, scores: Scores, kind: int) -> list[ActionChoice]:
        """The best role assignments of one kind in which something new takes part and that can be performed."""
        roles = np.meshgrid(*(self.candidates(observed, kind, slot) for slot in range(3)), indexing="ij")
        target, tool, frame = (role.ravel() for role in roles)
        if not len(target):
            return []
        total = np.where(target >= 0, scores.target[kind, target], 0.0)
        total = total + np.where(tool >= 0, scores.tool[kind, target, tool], 0.0)
        total = total + np.where(frame >= 0, scores.frame[kind, target, frame], 0.0)
        order = np.lexsort((_apart(observed, target, tool) + _apart(observed, target, frame), -total))
        order = order[self._possible(observed, kind, target, tool, frame)[order]][:MOST_ASSIGNMENTS]
        slots = np.stack([target, tool, frame], axis=1)[order].tolist()
        return [ActionChoice(kind, (one[0], one[1], one[2]), float(scores.wanted[kind])) for one in slots]

    def _possible(self, observed: BehaviourObservation, kind: int, target: Ints, tool: Ints, frame: Ints) -> Bools:
        new = np.append(observed.new, False)
        possible = new[target] | new[tool] | new[frame]
        possible &= (target < 0) | (target != tool)
        if self.kinds.kinds[kind].type in ("Insert", "Remove"):  # what is moved must not carry the frame along
            possible &= (target < 0) | (frame < 0) | ~observed.below[target, frame]
        possible &= (target < 0) | (tool < 0) | ~observed.below[tool, target]  # nor a tool what it comes to
        for slots in observed.slots[observed.kind == kind].tolist():
            possible &= (target != slots[0]) | (tool != slots[1]) | (frame != slots[2])
        return possible


def _apart(observed: BehaviourObservation, one: Ints, other: Ints) -> Floats:
    """Metres between objects (N,), 0 where one is none: of equals the nearest are taken."""
    position = np.append(observed.position, np.full((1, 3), np.nan), axis=0)
    return np.nan_to_num(np.linalg.norm(position[one] - position[other], axis=1))
