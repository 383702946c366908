"""How far the trees help on rooms that they have not seen, and where they do not: then plain places are drawn."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...generate.observe.observed_scene import ObservedScene
from ...generate.observe.placeable import box_placeable
from ...generate.observe.prior_tables import PriorTables
from ...generate.observe.seen_places import on_floors
from ...generate.propose.proposer import Query
from ...generate.propose.trees_proposer import SHARPNESS, TreesProposer
from ...geometry.arrays import Floats
from ...metrics.energy_score import DRAWS, energy_scores
from .examples import movable, without_above

REMOVED, REPEATS = 5, 3
"""Things that are taken out of a held-out room at a time, and how often."""

POWERS = (0.0, 0.5, 0.75, 1.0, SHARPNESS, 2.0, 2.5, 3.0)
"""Powers of the trees' odds that are tried; 0: all plain proposals alike."""

FLOOR, HUNG, ON_THINGS = GROUPS = ("floor", "hung", "on things")


@dataclass(frozen=True, eq=False)
class HeldOut:
    """An object of a held-out room: category and group, and energy scores in metres: of plain places, and by power."""

    category: int
    group: str
    plain: float
    powers: Floats

    def taken(self, power: float | None) -> float:
        """The energy with one of :data:`POWERS`; None: of plain places."""
        return self.plain if power is None else float(self.powers[POWERS.index(power)])


@dataclass(frozen=True, eq=False)
class TakenOut:
    """An object that was taken out of a room with others: its number there, its group, its true place (x, y, z of the
    bottom, turn), and the question where in the rest of the room it would be."""

    obj: int
    group: str
    true: Floats
    query: Query


def taken_out(
    scene: ObservedScene, tables: PriorTables, vocabulary: Sequence[str], rng: np.random.Generator
) -> Iterator[TakenOut]:
    """Take some things out of a scene; what has lost its support is not asked for."""
    taken = rng.permutation(movable(scene, tables))[:REMOVED]
    kept = without_above(scene, taken.tolist())
    rest, floor = scene.part(kept), on_floors(scene, tables)
    for obj in taken.tolist():
        support, category, half = int(scene.support[obj]), int(scene.category[obj]), scene.half[obj]
        if support >= 0 and not kept[support]:
            continue
        on_thing = support >= 0 and not tables.structural[scene.category[support]]
        group = ON_THINGS if on_thing else FLOOR if floor[obj] else HUNG
        known = tables.usual[category][rest.category] & (rest.category >= 0)
        true = np.array([*scene.center[obj, :2], scene.center[obj, 2] - half[2], scene.yaw[obj]])
        query = Query(rest, category, box_placeable(vocabulary[category], 2 * half), known, {})
        yield TakenOut(obj, group, true, query)


def measured(
    proposer: TreesProposer, scenes: Sequence[ObservedScene], tables: PriorTables, rng: np.random.Generator
) -> Iterator[HeldOut]:
    """What becomes of things that are taken out of scenes and asked for again."""
    vocabulary = proposer.model.contract.vocabulary
    for scene in [scene for scene in scenes for _ in range(REPEATS)]:
        for one in taken_out(scene, tables, vocabulary, rng):
            plain = energy_scores(proposer.bootstrapped(one.query, DRAWS, rng).places, one.true)[0]
            powers = [energy_scores(proposer.drawn(one.query, DRAWS, rng, each).places, one.true)[0] for each in POWERS]
            yield HeldOut(int(scene.category[one.obj]), one.group, plain, np.array(powers))


@dataclass(frozen=True)
class Choice:
    """What is drawn of a group: of ``objects`` held-out ones the mean energy of plain places and of those ``taken``,
    metres; the power, None where plain places are as good."""

    group: str
    objects: int
    plain: float
    taken: float
    power: float | None

    def to_record(self) -> dict[str, Any]:
        """JSON-ready."""
        energies = {} if not self.objects else {"plain": round(self.plain, 3), "taken": round(self.taken, 3)}
        return {"group": self.group, "objects": self.objects, "power": self.power, **energies}

    def note(self) -> str:
        """What is to be said of it, "" for nothing."""
        if not self.objects:
            return ""
        if self.power is None:
            return f"{self.group}: learning does not help on held-out rooms; as in a training room is where things go"
        share = 1 - self.taken / self.plain
        return f"{self.group}: {share:.0%} less error on held-out rooms than places copied from training rooms"


def choices(found: Sequence[HeldOut]) -> dict[str, Choice]:
    """The best for each group, by the mean over its held-out objects; plain places for what was never asked for."""
    result = {}
    for group in GROUPS:
        mine = [one for one in found if one.group == group]
        if not mine:
            result[group] = Choice(group, 0, float("nan"), float("nan"), None)
            continue
        plain, powers = float(np.mean([one.plain for one in mine])), np.mean([one.powers for one in mine], axis=0)
        best = int(powers.argmin())
        better = bool(powers[best] < plain)
        power = POWERS[best] if better else None
        result[group] = Choice(group, len(mine), plain, float(powers[best]) if better else plain, power)
    return result


def groups_of(scenes: Sequence[ObservedScene], tables: PriorTables) -> dict[int, str]:
    """The group in which most objects of each category are."""
    counts: dict[int, dict[str, int]] = defaultdict(lambda: dict.fromkeys(GROUPS, 0))
    for scene in scenes:
        floor = on_floors(scene, tables)
        for obj in movable(scene, tables):
            support = int(scene.support[obj])
            on_thing = support >= 0 and not tables.structural[scene.category[support]]
            counts[int(scene.category[obj])][ON_THINGS if on_thing else FLOOR if floor[obj] else HUNG] += 1
    return {category: max(GROUPS, key=lambda group: found[group]) for category, found in counts.items()}
