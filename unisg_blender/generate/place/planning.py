"""Planning: level by level, what stands where is decided first, and then in which order each support is filled."""

from __future__ import annotations

import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...scene.categories import STRUCTURE
from ..observe.contract import Contract
from ..observe.observed_scene import ObservedScene
from ..observe.placeable import Placeable
from ..observe.placement_order import groups, ranks, row_order
from ..observe.support_candidates import SupportOccupancy
from ..observe.support_priors import CategoryPriors
from ..propose.anchor_proposer import AnchorProposer, SupportChoice, Upcoming
from .spanning_objects import fit_for


@dataclass(frozen=True, eq=False)
class Planned:
    """Object ``number`` and, where a support was chosen for it, the ``candidate`` (object, surface) and what else
    comes there.

    ``milliseconds`` is its share of the time that planning took.
    """

    number: int
    candidate: tuple[int, int] | None = None
    row: Upcoming = field(default_factory=lambda: Upcoming({}, 0.0))
    choice: SupportChoice | None = None
    milliseconds: float = 0.0


def usual_kinds(vocabulary: Sequence[str], priors: CategoryPriors) -> NDArray[np.bool_]:
    """Which categories (columns) hold a category (row), (C, C + 1); the last column: it may stand on the ground."""
    place = {name: number for number, name in enumerate((*vocabulary, ""))}
    usual = np.zeros((len(vocabulary), len(vocabulary) + 1), bool)
    for row, name in enumerate(vocabulary):
        usual[row, [place[prior.support] for prior in priors.supports.get(name, ()) if prior.support in place]] = True
    return usual


class Planner:
    """Chooses supports with the model, among what the scene has when a level begins.

    ``usual`` is what :func:`usual_kinds` gives for the contract.
    """

    def __init__(
        self, proposer: AnchorProposer, scene: ObservedScene, contract: Contract, placeables: Sequence[Placeable],
        usual: NDArray[np.bool_], rng: np.random.Generator,
    ) -> None:  # fmt: skip
        self.proposer, self.scene, self.placeables, self.usual, self.rng = proposer, scene, placeables, usual, rng
        self.vocabulary, self.priors = contract.vocabulary, contract.priors
        movable = np.array([name not in STRUCTURE for name in (*self.vocabulary, "")])
        there = movable[scene.category]
        self.furnished = set(scene.support[there].tolist())
        fewest = min((int(np.dot(room, movable[:-1])) for room in self.priors.rooms), default=0)
        if len(placeables) + there.sum() < fewest:  # no whole room: more may come
            self.furnished |= set(np.flatnonzero(scene.support < 0).tolist())

    def order(self, wanted: Sequence[str], coming: Mapping[str, int]) -> Iterator[Planned]:
        """All objects in the order of placing; whoever takes one places it before asking for the next."""
        numbers = {name: number for number, name in enumerate(self.vocabulary)}
        category = np.array([numbers[name] for name in wanted])
        level, rank = groups(self.vocabulary, self.priors)[category], ranks(self.vocabulary, self.priors)[category]
        left = Counter(category.tolist())
        for step in np.unique(level):
            start = time.perf_counter()
            mine = np.flatnonzero(level == step)
            mine = mine[np.argsort(rank[mine], kind="stable")]
            planned = self._level(mine, category, left)
            spent = 1e3 * (time.perf_counter() - start) / len(mine)
            for item in planned:
                yield Planned(item.number, item.candidate, item.row, item.choice, spent)

    def _level(self, mine: NDArray[np.int64], category: NDArray[np.int64], left: Counter[int]) -> list[Planned]:
        """The objects of one level: a candidate for each, then support after support."""
        load = SupportOccupancy.of(self.scene, np.ones(len(self.scene.category), bool))
        candidates: dict[int, tuple[int, int]] = {}
        choices: dict[int, SupportChoice] = {}
        for number in mine.tolist():
            kind, placeable = int(category[number]), self.placeables[number]
            left[kind] -= 1
            allowed = self.usual[kind][self.scene.category] & (self.scene.category >= 0)
            allowed = fit_for(self.vocabulary[kind], placeable.half, self.scene, allowed, self.priors)
            if not allowed.any():
                continue
            empty = not self.furnished.intersection(np.flatnonzero(allowed).tolist())
            choice = self.proposer.choose(self.scene, load, kind, placeable.half, allowed, left, empty)
            total = np.cumsum(np.exp(choice.score))
            drawn = int(np.searchsorted(total, self.rng.random() * total[-1]).clip(max=len(total) - 1))
            candidates[number] = int(choice.candidates.obj[drawn]), int(choice.candidates.surface[drawn])
            choices[number] = choice
            load = load.with_object(*candidates[number], kind, float(4 * placeable.half[0] * placeable.half[1]))
        return self._filled(mine, category, candidates, choices)

    def _filled(
        self, mine: NDArray[np.int64], category: NDArray[np.int64], candidates: Mapping[int, tuple[int, int]],
        choices: Mapping[int, SupportChoice],
    ) -> list[Planned]:  # fmt: skip
        """Support after support, each in the order of its row; what has no candidate comes last."""
        on: dict[int, list[int]] = defaultdict(list)
        for number, (obj, _) in candidates.items():
            on[obj].append(number)
        for numbers in on.values():  # the lower surfaces first
            numbers.sort(key=lambda number: candidates[number][1])
        result = []
        for obj, numbers in on.items():
            names = [self.vocabulary[category[number]] for number in numbers]
            kind = self.scene.category[obj]
            order = row_order(
                names, self.vocabulary[kind] if kind >= 0 else "", self.scene.support[obj] < 0, self.priors, self.rng
            )
            numbers = [numbers[position] for position in order]
            counts = Counter(category[numbers].tolist())
            area = sum(float(4 * self.placeables[number].half[:2].prod()) for number in numbers)
            for number in numbers:
                counts[int(category[number])] -= 1
                area -= float(4 * self.placeables[number].half[:2].prod())
                left = {kind: count for kind, count in counts.items() if count}
                row = Upcoming(left, max(area, 0.0), obj not in self.furnished)
                result.append(Planned(number, candidates[number], row, choices[number]))
        return result + [Planned(int(number)) for number in mine if int(number) not in candidates]
