"""Training examples for the network of behaviour: scenes with new objects, whose actions are missing in part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.utils.data import Dataset

from ...generate.behaviour.action_kinds import Kinds
from ...generate.behaviour.action_policy import RoleMasks
from ...generate.behaviour.network_policy import observation_arrays
from ...generate.behaviour.observation import BehaviourObservation
from ..padding import padded_stack

Made = list[tuple[int, tuple[int, int, int], int]]
"""What is missing: kind, slots, and the column of the leaf that it follows (-1: not to be learned)."""


class BehaviourExamples(Dataset[dict[str, Any]]):
    """Examples by number, other ones every time; ``fresh`` False for a fixed set to validate on."""

    def __init__(self, plays: Sequence[BehaviourObservation], kinds: Kinds, count: int, seed: int, fresh: bool) -> None:
        self.plays, self.kinds, self.count = plays, kinds, count
        self.casting = RoleMasks(kinds)
        self.rng = np.random.default_rng(seed)
        self.fixed = None if fresh else [self._draw() for _ in range(count)]

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, index: int) -> dict[str, Any]:
        return self._draw() if self.fixed is None else self.fixed[index]

    def _draw(self) -> dict[str, Any]:
        play = self.plays[int(self.rng.integers(len(self.plays)))]
        if self.rng.random() < 0.3:
            play = without_some(play, self.rng)
        new = draw_new(play, self.rng)
        return example(play, new, self.kinds, self.casting, self.rng)


def without_some(play: BehaviourObservation, rng: np.random.Generator) -> BehaviourObservation:
    """The scene without all objects of some categories and the actions in which they play."""
    hidden = rng.random(int(play.category.max(initial=-1)) + 2) < rng.random() * 0.6
    keep = ~hidden[play.category]
    if not keep.any():
        return play
    number = np.where(keep, np.cumsum(keep) - 1, -1)
    slots = np.where(play.slots >= 0, number[play.slots], -1)
    roled = ((play.slots < 0) | (slots >= 0)).all(axis=1)
    support = play.support[keep]
    return replace(
        play, rows=play.rows[keep], category=play.category[keep], new=play.new[keep],
        support=np.where(support >= 0, number[support], -1), relation=play.relation[keep], position=play.position[keep],
        below=play.below[np.ix_(keep, keep)], kind=play.kind[roled], slots=slots[roled],
        leaf_stage=play.leaf_stage[roled], leaf_order=play.leaf_order[roled],
    )  # fmt: skip


def draw_new(play: BehaviourObservation, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Which objects are new: one (mostly one that plays in actions), a few, or all."""
    count = len(play.rows)
    new = np.zeros(count, bool)
    acting = np.unique(play.slots[play.slots >= 0])
    dice = rng.random()
    if dice < 0.2:
        new[:] = True
    elif dice < 0.4:
        new[rng.random(count) < rng.random()] = True
    if not new.any():
        new[rng.choice(acting) if len(acting) and rng.random() < 0.7 else rng.integers(count)] = True
    return new


def example(
    play: BehaviourObservation, new: NDArray[np.bool_], kinds: Kinds, casting: RoleMasks, rng: np.random.Generator
) -> dict[str, Any]:
    """One example: some of the actions in which something new plays are there, the others are to be made."""
    mine = np.append(new, False)[play.slots].any(axis=1)
    gone = mine & (rng.random(len(mine)) < (1.0 if rng.random() < 0.3 else rng.random()))
    if rng.random() < 0.2:  # lessons that lack whole stages
        stages = rng.random(len(kinds.stages) + 1) < 0.4
        kept = ~gone & ~(stages[play.leaf_stage] & ~mine)
    else:
        kept = ~gone
    context = replace(play.keep_actions(kept), new=new)
    column = np.cumsum(kept) - 1
    made: Made = []
    for roled_action in np.flatnonzero(gone & (play.kind >= 0)).tolist():
        slots = play.slots[roled_action].tolist()
        made.append(
            (int(play.kind[roled_action]), (slots[0], slots[1], slots[2]), _follows(play, roled_action, kept, column))
        )
    able = [kind for kind in range(len(kinds.kinds)) if feasible(casting, context, kind)]
    return {"arrays": observation_arrays(context, kinds), "made": made, "able": able}


def _follows(play: BehaviourObservation, roled_action: int, kept: NDArray[np.bool_], column: NDArray[np.int64]) -> int:
    """The column of the leaf before an action's own: of an action, ``A + stage`` for the beginning, -1 for neither."""
    stage, order = play.leaf_stage[roled_action], play.leaf_order[roled_action]
    there = np.flatnonzero(kept & (play.leaf_stage == stage) & (play.leaf_order >= 0))
    if stage < 0 or order < 0 or not len(there):
        return -1
    before = there[play.leaf_order[there] < order]
    return int(column[before[play.leaf_order[before].argmax()]]) if len(before) else int(kept.sum() + stage)


def feasible(casting: RoleMasks, play: BehaviourObservation, kind: int) -> bool:
    """Is there somebody for each part, and somebody new for one?"""
    parts = [casting.candidates(play, kind, slot) for slot in range(3)]
    fresh = np.append(play.new, False)
    return all(len(part) for part in parts) and any(fresh[part].any() for part in parts)


def collate(examples: Sequence[dict[str, Any]], kinds: int) -> dict[str, Tensor]:
    """A batch: padded arrays, ``wanted`` (B, K) with ``able`` (B, K), and what is to be made as rows."""
    arrays = [item["arrays"] for item in examples]
    batch = {name: padded_stack([one[name] for one in arrays]) for name in arrays[0]}
    roled = batch["act_mask"].shape[1]
    wanted, able = torch.zeros(len(examples), kinds), torch.zeros(len(examples), kinds)
    made = []
    for place, item in enumerate(examples):
        able[place, item["able"]] = 1
        here = len(item["arrays"]["act_mask"])
        for kind, slots, follows in item["made"]:
            wanted[place, kind] = 1
            made.append([place, kind, *slots, follows + (roled - here if follows >= here else 0)])
    batch |= {"wanted": wanted, "able": able, "made": torch.tensor(made, dtype=torch.int64).reshape(-1, 6)}
    return batch
