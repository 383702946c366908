"""Which action comes next: scores of kinds and parts, and the casts that they favour among those that are possible."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from .action_kinds import Kinds
from .observation import BehaviourObservation, Slots

CASTS = 3
"""Casts offered for one kind, at most."""

SURE, NEVER = 0.5, 0.1
"""Actions at least this likely are always made, those less likely than the other are never; between, a draw decides."""


@dataclass(frozen=True, eq=False)
class Scores:
    """What a chooser thinks of a scene with E objects, for K kinds of actions.

    ``wanted`` (K,): the probability that (another) action of the kind is to be made;
    ``target`` (K, E), ``tool`` and ``frame`` (K, E, E), by target first: log probabilities or the like, to be added up.
    """

    wanted: Floats
    target: Floats
    tool: Floats
    frame: Floats


@dataclass(frozen=True)
class ActionChoice:
    """An action to make: its kind, which objects play target, tool and frame in it (-1: none), its probability."""

    kind: int
    slots: Slots
    score: float


class ActionPolicy(Protocol):
    """Says what actions are missing in a scene."""

    kinds: Kinds

    def scores(self, play: BehaviourObservation) -> Scores:
        """The scores for the next action."""

    def after(self, play: BehaviourObservation, choice: ActionChoice) -> int:
        """Behind which act's leaf, of the kind's stage, the new one goes; -1: it is the stage's first."""


class Casting:
    """Which categories may play which part in which kind, as masks."""

    def __init__(self, kinds: Kinds) -> None:
        self.kinds = kinds
        place = {name: number for number, name in enumerate(kinds.categories)}
        self.allowed = np.zeros((len(kinds.kinds), 3, len(kinds.categories) + 1), bool)
        self.used = np.zeros((len(kinds.kinds), 3), bool)
        for number, kind in enumerate(kinds.kinds):
            for slot, names in enumerate(kind.slots):
                self.used[number, slot] = bool(names)
                self.allowed[number, slot, [place[name] for name in names if name in place]] = True

    def candidates(self, play: BehaviourObservation, kind: int, slot: int) -> Ints:
        """The objects that may play a part, [-1] where the kind has no such part."""
        if not self.used[kind, slot]:
            return np.array([-1])
        return np.flatnonzero(self.allowed[kind, slot, play.category])

    def anybody(self, play: BehaviourObservation) -> bool:
        """Whether something new may play any part."""
        return bool(play.new.any() and self.allowed[:, :, play.category[play.new]].any())

    def limits(self, rng: np.random.Generator | None) -> Floats:
        """The least probability (K,) with which each kind is made: drawn, so that what is done now and then is."""
        count = len(self.kinds.kinds)
        return np.full(count, SURE) if rng is None else rng.random(count).clip(NEVER, SURE)

    def choices(self, play: BehaviourObservation, scores: Scores, least: Floats) -> list[ActionChoice]:
        """Actions that are wanted with at least these probabilities (K,), best first, each kind with its best casts."""
        found = []
        wanted = np.flatnonzero(scores.wanted >= least)
        for kind in wanted[np.argsort(-scores.wanted[wanted])].tolist():
            found += self.casts(play, scores, kind)
        return found

    def casts(self, play: BehaviourObservation, scores: Scores, kind: int) -> list[ActionChoice]:
        """The best casts of one kind in which something new plays and that can be performed."""
        targets, tools, frames = (self.candidates(play, kind, slot) for slot in range(3))
        if not (len(targets) and len(tools) and len(frames)):
            return []
        target, tool, frame = (part.ravel() for part in np.meshgrid(targets, tools, frames, indexing="ij"))
        total = np.where(target >= 0, scores.target[kind, target], 0.0)
        total = total + np.where(tool >= 0, scores.tool[kind, target, tool], 0.0)
        total = total + np.where(frame >= 0, scores.frame[kind, target, frame], 0.0)
        possible = self._possible(play, kind, target, tool, frame)
        near = _tie_break(play, target, tool, frame)
        order = np.lexsort((near, -total))
        order = order[possible[order]][:CASTS]
        wanted = float(scores.wanted[kind])
        return [ActionChoice(kind, (int(target[i]), int(tool[i]), int(frame[i])), wanted) for i in order]

    def _possible(self, play: BehaviourObservation, kind: int, target: Ints, tool: Ints, frame: Ints) -> Bools:
        new = np.append(play.new, False)
        possible = new[target] | new[tool] | new[frame]
        possible &= (target < 0) | (target != tool)
        moves = self.kinds.kinds[kind].type in ("Insert", "Remove")
        if moves:  # what is moved must not carry the frame along, nor a tool what it comes to
            possible &= (target < 0) | (frame < 0) | ~play.below[target, frame]
        possible &= (target < 0) | (tool < 0) | ~play.below[tool, target]
        for slots in play.slots[play.kind == kind].tolist():
            possible &= (target != slots[0]) | (tool != slots[1]) | (frame != slots[2])
        return possible


def _tie_break(play: BehaviourObservation, target: Ints, tool: Ints, frame: Ints) -> Floats:
    """Of equals the nearest: metres between what plays together."""
    there = np.append(play.place, np.full((1, 3), np.nan), axis=0)
    apart = [np.linalg.norm(there[target] - there[other], axis=1) for other in (tool, frame)]
    return np.nan_to_num(apart[0]) + np.nan_to_num(apart[1])
