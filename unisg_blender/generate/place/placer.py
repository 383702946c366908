"""Placing: one object after another is planned, gets proposals, is settled, checked and added."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...dataset.assets.asset import Asset
from ...errors import UniSGError
from ...geometry.arrays import Bools, Floats
from ...scene import SceneGraph
from ...spatial.objects import middle_of
from ..observe.placeable import Placeable
from ..observe.support_priors import RESTS
from ..propose.place_sampling import USUAL, Sampling
from ..propose.proposer import Proposals, Proposer, Query
from ..propose.requests import Beside, On
from .growing_scene import GrowingScene, Target
from .placement_record import Placement
from .proposal_selection import FoundPlace, first_fitting
from .refusal_reason import CUTS_FLOOR, why_not
from .scene_extension import Names, UidMaker
from .shape_library import Library
from .spanning_objects import reaches
from .support_planner import Planned, Planner

BATCHES = (8, 24, 28)
"""Proposals asked for at a time, until one fits: first on the candidate that was planned, then on any."""

TRIED = 3
"""So often is a category tried while nothing else is placed: then nothing of it is, until something is."""

OTHER_SHAPES = 2
"""Further shapes to try when the first one finds no place."""


LIFT = 5e-7
"""Metres under what stands, so that none of its faces crosses the one below it in single precision."""


class ObjectPlacer:
    """One call of :meth:`Generator.add`: the scene while it grows, and what is to be placed there.

    All objects are put ``on``, or ``beside``, the object with that uid or name; "" for anywhere. Of a house with
    several rooms it is the one that the point ``within`` (3,) is in, or else that this object is in, or the largest.
    """

    def __init__(
        self, proposer: Proposer, library: Library, graph: SceneGraph, rng: np.random.Generator, settle: bool,
        wanted: Sequence[int], assets: Mapping[int, Sequence[Asset]], on: str = "", beside: str = "",
        within: Floats | None = None, ways: bool = True, sampling: Sampling = USUAL,
    ) -> None:  # fmt: skip
        self.proposer, self.library, self.graph, self.rng, self.settle = proposer, library, graph, rng, settle
        near = middle_of(graph, on or beside) if on or beside else within
        self.scene = GrowingScene(graph, library.model.contract, near, within is not None)
        self.scene.ways.wanted, self.scene.sampling = ways, sampling
        self.coming = Counter(wanted)
        left = {category: [Placeable(asset) for asset in shapes] for category, shapes in assets.items()}
        self.targets = [
            Target(category, left[category].pop(0), True) if left.get(category) else self._target(category)
            for category in wanted
        ]
        self.in_vain: dict[int, list[str]] = {}  # by category the notes since something was placed
        self.on: On | None = None
        self.beside: Beside | None = None
        self._request(on, beside)

    def _request(self, on: str, beside: str) -> None:
        if on:
            self.proposer = self.on = On(self.proposer, self.scene.find(self.graph, on), self.scene.tables.usual)
        if beside:
            obj = self.scene.find(self.graph, beside)
            if self.scene.labels[obj].floor:
                raise UniSGError(f"everything is beside {beside!r}: name an object that stands on it")
            self.proposer = self.beside = Beside(self.proposer, obj)

    def order(self, bulk: bool) -> Iterator[Planned]:
        """The objects in the order of placing; in ``bulk`` with proposals for all of them, none seeing another."""
        if bulk:
            queries = [self._query(target, self._holders(target.category)[0]) for target in self.targets]
            early = [self.proposer.propose(query, BATCHES[0], self.rng) for query in queries]
            return (Planned(number, early=proposals) for number, proposals in enumerate(early))
        rooms = self.library.model.contract.priors.rooms
        return Planner(self.proposer, self.scene, rooms, self.targets, self.rng).order()

    def place(self, planned: Planned, names: Names, make_uid: UidMaker) -> Placement:
        """Find a place for an object and add it, or say why there is none."""
        start, category = time.perf_counter(), self.targets[planned.number].category
        self.coming[category] -= 1
        allowed, note = self._holders(category)
        found = None
        if note and next(iter(self.scene.tables.supports[category].values())).contact != RESTS:
            note = f"{note} to hold it"
        elif len(before := self.in_vain.get(category, [])) >= TRIED and not self.targets[planned.number].chosen:
            note = before[-1]
        else:
            found = self._find(planned, allowed)
            note = (self._remark(found) or note) if found.fits else self._why_not(found)
        spent = planned.milliseconds + 1e3 * (time.perf_counter() - start)
        if found is None or not found.fits:
            draws = 0 if found is None else found.draws
            self.in_vain.setdefault(category, []).append(note)
            return Placement(self.scene.vocabulary[category], draws=draws, milliseconds=spent, note=note)
        return self._add(found, names, make_uid, note, spent)

    def _target(self, category: int) -> Target:
        """An object of a shape at random; of what spans a room, one that reaches across this one, if any does."""

        def fits(placeable: Placeable) -> bool:
            """Does it reach across from any of its holders?"""
            return reaches(self.scene.observed, self.scene.holders(category)[0], placeable.half)

        spanning = self.scene.tables.spanning[category]
        return Target(category, self.library.placeable(category, self.graph, self.rng, fits if spanning else None))

    def _holders(self, category: int) -> tuple[Bools, str]:
        """Which objects may hold a category, and what to say where none of the usual ones is there."""
        return (self.on.holders(self.scene.observed), "") if self.on else self.scene.holders(category)

    def _query(self, target: Target, allowed: Bools) -> Query:
        return self.scene.query(target, allowed, +self.coming)

    def _find(self, planned: Planned, allowed: Bools) -> FoundPlace:
        """A place for an object: of its first proposal as it is, or settled, then of other shapes."""
        target = self.targets[planned.number]
        query = self._query(target, allowed)
        if not self.settle:
            first = next(self._batches(query, planned, (1,)))
            return FoundPlace(target, int(first.support[0]), first.places[0])
        found = first_fitting(self.scene, target, self._batches(query, planned, BATCHES), self.on is not None)
        for _ in range(0 if target.chosen or found.fits else OTHER_SHAPES):
            other = self._target(target.category)
            batches = self._batches(self._query(other, allowed), replace(planned, early=None), BATCHES)
            if (tried := first_fitting(self.scene, other, batches, self.on is not None)).fits:
                return tried
        return found

    def _batches(self, query: Query, planned: Planned, counts: Sequence[int]) -> Iterator[Proposals]:
        """Proposals, so many at a time: all but the last on the candidate that was planned, if one was."""
        if planned.early is not None:
            yield planned.early
        for step, count in enumerate(counts):
            if planned.candidate is None or (step and step == len(counts) - 1):
                yield self.proposer.propose(query, count, self.rng)
            else:
                yield self.proposer.propose_on(query, count, self.rng, planned.candidate, planned.row, planned.choice)

    def _remark(self, found: FoundPlace) -> str:
        """What is to be said of a place for what was wanted beside something."""
        if self.beside is None or not self.settle:
            return ""
        near = self.beside.has(self.scene.observed, found.target.placeable.half, found.place)
        return "" if near else f"no room beside {self.scene.labels[self.beside.obj].name}"

    def _why_not(self, found: FoundPlace) -> str:
        """Why nothing fits."""
        target, name = found.target, self.scene.labels[found.support].name if found.support >= 0 else ""
        support = self.scene.support(target.category, found.support)
        if found.cuts:
            return CUTS_FLOOR
        return why_not(target.placeable, found.place, target.category, support, name, self.scene.space)

    def _add(self, found: FoundPlace, names: Names, make_uid: UidMaker, note: str, spent: float) -> Placement:
        self.in_vain.clear()
        target, support, place = found.target, found.support, found.place
        depth = 0.0
        if not self.settle:
            depth = float(self.scene.space.depth(target.placeable, place[None], target.category, support)[0])
        held_by = self.scene.labels[support].name if support >= 0 else ""
        if self.settle and self.scene.support(target.category, support).contact == RESTS:
            place = place + np.array([0, 0, LIFT, 0])
        made = self.scene.add(target, support, place, names, make_uid)
        return Placement(
            made.category, made.name, made.uid, held_by, made.world, depth, found.draws, found.searched, spent, note,
            source=target.placeable.asset.source,
        )  # fmt: skip
