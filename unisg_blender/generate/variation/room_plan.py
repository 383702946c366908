"""What becomes of the things of a scene in one variation: what goes, and what is to be added."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...scene.categories import STRUCTURE
from .things import Things
from .variation import NOTHING, SCENE, TRAINING, Count, Variation


@dataclass(frozen=True)
class RoomPlan:
    """The rows that go, ascending, and how many of each category are to be added."""

    gone: tuple[int, ...]
    wanted: dict[str, int]


def plan_room(
    things: Things, variation: Variation, training: Mapping[str, int], has_room: bool, rng: np.random.Generator
) -> RoomPlan:
    """Draw a variation of a scene.

    What stands on something that goes, goes too and is placed anew, unless it is to go itself; nothing that is locked
    goes, nor what it stands on.

    Parameters
    ----------
    things
        Those of the scene.
    variation
        What varies; its categories are the model's.
    training
        How many of each category a room has that the model was trained on.
    has_room
        Whether the scene has a floor: then nothing of a building is added.
    """
    locked = things.named(variation.lock)
    removed, rerolled = (set(things.chosen(chances, rng)) for chances in (variation.remove, variation.reroll))
    gone: set[int] = set()
    for row in things.rows:
        if row in removed | rerolled and not locked & set(load := things.with_load(row)):
            gone.update(load)
    counts = _drawn(things, variation, training, rng)
    for name, target in counts.items():
        there = things.count(set(things.rows) - gone)[name]
        gone |= _surplus(things, name, max(there - target, 0), gone, locked, rng)
    kept, all_but_removed = (things.count(set(things.rows) - out) for out in (gone, gone & removed))
    wanted = {name: target - kept[name] for name, target in {**all_but_removed, **counts}.items()}
    built = STRUCTURE if has_room else ()
    added = {name: many for name, many in wanted.items() if many > 0 and name not in built}
    return RoomPlan(tuple(sorted(gone)), added)


def _drawn(
    things: Things, variation: Variation, training: Mapping[str, int], rng: np.random.Generator
) -> dict[str, int]:
    """How many of each category there are to be in the end; categories that stay as they are left out."""
    there = things.count(things.rows)
    rest = variation.rest or (SCENE if things.rows else TRAINING)
    others = {TRAINING: training, NOTHING: dict.fromkeys(there, 0)}.get(rest, {})
    least = there if rest == TRAINING else {}  # what a scene has beyond a room of training stays
    found = {name: max(many, least.get(name, 0)) for name, many in others.items() if name not in variation.counts}
    for name, count in variation.counts.items():
        found[name] = _number(count, training.get(name, 0), there[name], rng)
    return found


def _number(count: Count, trained: int, there: int, rng: np.random.Generator) -> int:
    """A number as a count says."""
    drawn, chance = int(rng.integers(count.least, count.most + 1)), rng.random()
    number = {TRAINING: trained, SCENE: there}.get(count.like, drawn)
    return number if chance < count.chance else 0


def _surplus(
    things: Things, category: str, many: int, gone: set[int], locked: set[int], rng: np.random.Generator
) -> set[int]:
    """Things of a category to be taken out, with what stands on them."""
    mine = [row for row in things.rows if things.category[row] == category and row not in gone]
    free = [row for row in mine if not locked & set(things.with_load(row))]
    chosen = {free[place] for place in rng.permutation(len(free))[:many].tolist()}
    return {other for row in chosen for other in things.with_load(row)}
