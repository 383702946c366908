"""Planning: level by level, what stands where is decided first, and then in which order each support is filled."""

from __future__ import annotations

import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...geometry.arrays import Ints
from ..observe.prior_tables import PriorTables
from ..observe.support_candidates import SupportOccupancy
from ..propose.proposer import NOTHING_ELSE, Proposals, Proposer, SupportChoice, Upcoming
from .growing_scene import GrowingScene, Target


@dataclass(frozen=True, eq=False)
class Planned:
    """Object ``number`` and, where a support was chosen for it, the ``candidate`` (object, surface) and what else
    comes there; or proposals that were made ``early``.

    ``milliseconds`` is its share of the time that planning took.
    """

    number: int
    candidate: tuple[int, int] | None = None
    row: Upcoming = NOTHING_ELSE
    choice: SupportChoice | None = None
    early: Proposals | None = None
    milliseconds: float = 0.0


class Planner:
    """Chooses supports with the model, among what the scene has when a level begins.

    A model that makes no choice leaves the objects in their order without candidates. ``rooms`` are counts of the
    categories in rooms of the training set.
    """

    def __init__(
        self, proposer: Proposer, scene: GrowingScene, rooms: Sequence[Sequence[int]], targets: Sequence[Target],
        rng: np.random.Generator,
    ) -> None:  # fmt: skip
        self.proposer, self.scene, self.targets, self.rng = proposer, scene, targets, rng
        observed, movable = scene.observed, ~scene.tables.structural
        there = movable[observed.category]
        self.furnished = set(observed.support[there].tolist())
        fewest = min((int(np.dot(room, movable[:-1])) for room in rooms), default=0)
        if len(targets) + there.sum() < fewest:  # no whole room: more may come
            self.furnished |= set(np.flatnonzero(observed.support < 0).tolist())

    def order(self) -> Iterator[Planned]:
        """All objects in the order of placing; whoever takes one places it before asking for the next."""
        category = np.array([target.category for target in self.targets])
        level, rank = self.scene.tables.level[category], self.scene.tables.rank[category]
        left = Counter(category.tolist())
        for step in np.unique(level):
            start = time.perf_counter()
            mine = np.flatnonzero(level == step)
            mine = mine[np.argsort(rank[mine], kind="stable")]
            planned = self._filled(mine, *self._chosen(mine, left))
            spent = 1e3 * (time.perf_counter() - start) / len(mine)
            yield from (replace(item, milliseconds=spent) for item in planned)

    def _chosen(self, mine: Ints, left: Counter[int]) -> tuple[dict[int, tuple[int, int]], dict[int, SupportChoice]]:
        """A candidate for each of the objects of one level for which there is any, and what it was chosen among."""
        scene = self.scene.observed
        load = SupportOccupancy.of(scene)
        candidates: dict[int, tuple[int, int]] = {}
        choices: dict[int, SupportChoice] = {}
        for number in mine.tolist():
            target = self.targets[number]
            left[target.category] -= 1
            query = self.scene.query(target, self.scene.usual_holders(target.category), left)
            empty = not self.furnished.intersection(np.flatnonzero(query.allowed).tolist())
            choice = self.proposer.choose(query, load, empty) if query.allowed.any() else None
            if choice is None:
                continue
            total = np.cumsum(np.exp(choice.score))
            drawn = int(np.searchsorted(total, self.rng.random() * total[-1]).clip(max=len(total) - 1))
            candidates[number] = int(choice.candidates.obj[drawn]), int(choice.candidates.surface[drawn])
            choices[number] = choice
            load = load.with_object(*candidates[number], target.category, target.footprint)
        return candidates, choices

    def _filled(
        self, mine: Ints, candidates: Mapping[int, tuple[int, int]], choices: Mapping[int, SupportChoice]
    ) -> list[Planned]:
        """Support after support, each in the order of its row; what has no candidate comes last."""
        on: dict[int, list[int]] = defaultdict(list)
        for number, (obj, _) in sorted(candidates.items(), key=lambda item: item[1][1]):  # the lower surfaces first
            on[obj].append(number)
        scene, result = self.scene.observed, []
        for obj in dict.fromkeys(obj for obj, _ in candidates.values()):
            kinds, floor = [self.targets[number].category for number in on[obj]], bool(scene.support[obj] < 0)
            order = row_order(kinds, int(scene.category[obj]), floor, self.scene.tables, self.rng)
            numbers = [on[obj][position] for position in order]
            counts = Counter(kinds)
            area = sum(self.targets[number].footprint for number in numbers)
            for number in numbers:
                counts[self.targets[number].category] -= 1
                area -= self.targets[number].footprint
                row = Upcoming(+counts, max(area, 0.0), obj not in self.furnished)
                result.append(Planned(number, candidates[number], row, choices[number]))
        return result + [Planned(int(number)) for number in mine if int(number) not in candidates]


def row_order(
    categories: Sequence[int], kind: int, floor: bool, tables: PriorTables, rng: np.random.Generator
) -> list[int]:
    """In which order objects of some categories are put on a support of a kind: positions in ``categories``."""
    if floor:
        return sorted(range(len(categories)), key=lambda position: int(tables.rank[categories[position]]))
    share = {}
    for category in sorted(set(categories)):
        seen = tables.orders.get((kind, category), ())
        along = seen[rng.integers(len(seen))] if seen else rng.random()
        share[category] = not tables.carriers[category], along, category
    return sorted(range(len(categories)), key=lambda position: share[categories[position]])
