"""Placing: one object after another gets proposals, is settled and takes up space."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from ...dataset.assets.asset import Asset
from ...errors import UniSGError
from ...scene import SceneGraph, world_matrices
from ...scene.categories import FLOOR, STRUCTURE
from ...spatial.floor_plan import room_outline
from ...spatial.objects import find_object, scene_objects
from ..observe.contract import Contract
from ..observe.observed_scene import ObservedScene
from ..observe.placeable import Placeable
from ..observe.support_priors import RESTS, SupportPrior
from ..propose.anchor_proposer import AnchorProposer
from ..propose.proposer import Proposals, Proposer
from ..propose.requests import BESIDE, Beside, On, aside, covers
from .free_space import FreeSpace
from .placement import Placement
from .planning import Planned, Planner, usual_kinds
from .scene_extension import Addition, Names, UidMaker
from .settling import Support, fitting, nearest_support, rest, search
from .shape_library import Library
from .spanning_objects import fit_for, reaches

BATCHES = (8, 24, 28)
"""Proposals asked for at a time, until one fits: first on the candidate that was planned, then on any."""

OTHER_SHAPES = 2
"""Further shapes to try when the first one finds no place."""

SEARCHED = 4
"""Supports whose whole surface is searched when no proposal fits."""


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A place (4,) on an object (-1: the ground), whether it ``fits``, and how it was found."""

    obj: int
    place: NDArray[np.float64]
    fits: bool
    draws: int
    searched: bool = False


class Placing:
    """One call of :meth:`Generator.add`: the scene while it grows."""

    def __init__(
        self,
        proposer: Proposer,
        library: Library,
        contract: Contract,
        graph: SceneGraph,
        rng: np.random.Generator,
        settle: bool,
        wanted: Sequence[str],
        assets: Mapping[str, Sequence[Asset]] | None = None,
    ) -> None:
        self.proposer, self.library, self.contract = proposer, library, contract
        self.priors, self.vocabulary = self.contract.priors, self.contract.vocabulary
        self.graph, self.rng, self.settle = graph, rng, settle
        objects = scene_objects(graph, self.vocabulary)
        self.scene = ObservedScene.of(objects, world_matrices(graph)[objects.row])
        self.uids = [graph.uid[row] for row in objects.row]
        self.names = [graph.name[row] for row in objects.row]
        self.kinds = [graph.category_name(row) for row in objects.row]
        has_floor = FLOOR in self.kinds and (graph.mesh[objects.row] >= 0)[self.kinds.index(FLOOR)]
        outline = room_outline(graph) if has_floor else None
        self.space = FreeSpace(objects.parts, objects.owner, objects.category, outline, self.priors, self.vocabulary)
        self.additions: list[Addition] = []
        self.coming = Counter(wanted)
        self.given: set[int] = set()
        self.usual = usual_kinds(self.vocabulary, self.priors)
        self.floor = self.vocabulary.index(FLOOR) if FLOOR in self.vocabulary else -2
        self.on = -1
        self.placeables = self._placeables(wanted, assets or {})
        self._resting: dict[tuple[str, int], Support] = {}

    def request(self, on: str, beside: str) -> None:
        """Put all objects on, or beside, the object with that uid or name; "" for anywhere."""
        if on:
            self.on = find_object(self.graph, self.uids, on)
            self.proposer = On(self.proposer, self.on, self.usual)
        if beside:
            obj = find_object(self.graph, self.uids, beside)
            if self.kinds[obj] == FLOOR:
                raise UniSGError(f"everything is beside {beside!r}: name an object that stands on it")
            self.proposer = Beside(self.proposer, obj)

    def order(self, wanted: Sequence[str]) -> Iterator[Planned]:
        """The objects in the order of placing, with the candidates planned for them, level by level."""
        if self.on >= 0 or not isinstance(self.proposer, AnchorProposer):
            yield from (Planned(number) for number in range(len(wanted)))
            return
        planner = Planner(self.proposer, self.scene, self.contract, self.placeables, self.usual, self.rng)
        yield from planner.order(wanted, self.coming)

    def _placeables(self, wanted: Sequence[str], assets: Mapping[str, Sequence[Asset]]) -> list[Placeable]:
        """A shape for each object, in order."""
        left = {name: [Placeable(asset) for asset in shapes] for name, shapes in assets.items()}
        placeables = []
        for number, name in enumerate(wanted):
            if left.get(name):
                self.given.add(number)
                placeables.append(left[name].pop(0))
            else:
                placeables.append(self._shape(name))
        return placeables

    def _shape(self, name: str) -> Placeable:
        """A shape at random; of what spans, one that reaches across in this room, if there is any."""
        if name not in self.priors.spans:
            return self.library.placeable(name, self.graph, self.rng)
        holders = self._allowed(name)[0]
        return self.library.placeable(
            name, self.graph, self.rng, lambda placeable: reaches(self.scene, holders, placeable.half)
        )

    def propose_all(self, wanted: Sequence[str]) -> list[Proposals]:
        """First proposals for all objects, none of them seeing another."""
        return [
            self._propose(name, placeable, BATCHES[0], self._allowed(name)[0])
            for name, placeable in zip(wanted, self.placeables, strict=True)
        ]

    def _propose(self, name: str, placeable: Placeable, count: int, allowed: NDArray[np.bool_]) -> Proposals:
        coming = {self.vocabulary.index(kind): number for kind, number in self.coming.items() if number}
        allowed = fit_for(name, placeable.half, self.scene, allowed, self.priors)
        return self.proposer.propose(
            self.scene, self.vocabulary.index(name), placeable, count, self.rng, allowed, coming
        )

    def _allowed(self, name: str) -> tuple[NDArray[np.bool_], str]:
        """Which objects may hold a category, and what to say where none of the usual ones is there."""
        if self.on >= 0:
            return covers(self.scene, self.on) | (np.arange(len(self.scene.category)) == self.on), ""
        usual = self.usual[self.vocabulary.index(name)]
        allowed = usual[self.scene.category]
        if allowed.any() or usual[-1]:
            return allowed & (self.scene.category >= 0), ""
        kinds = [prior.support for prior in self.priors.supports[name]]
        return self.scene.category == self.floor, f"no {' or '.join(kinds[:3])} in the scene"

    def _support(self, name: str, obj: int) -> Support:
        if (name, obj) not in self._resting:
            kind = self.kinds[obj] if obj >= 0 else ""
            prior = self.priors.prior(name, kind) or SupportPrior(kind, 0, RESTS)
            self._resting[name, obj] = Support(obj, prior, self.space.parts_of(obj), kind == FLOOR, name in STRUCTURE)
        return self._resting[name, obj]

    def place(
        self, planned: Planned, name: str, names: Names, make_uid: UidMaker, early: Proposals | None
    ) -> Placement:
        """Find a place for an object and add it, or say why there is none."""
        start, number = time.perf_counter(), planned.number
        self.coming[name] -= 1
        placeable = self.placeables[number]
        allowed, missing = self._allowed(name)
        candidate, note = None, missing
        if missing and self.priors.supports[name][0].contact != RESTS:
            note = f"{missing} to hold it"
        elif not self.settle:
            candidate = self._first(name, placeable, allowed, early, planned)
        else:
            candidate = self._drawn(name, placeable, allowed, early, planned)
            for _ in range(0 if number in self.given or candidate.fits else OTHER_SHAPES):
                placeable = self._shape(name)
                if (other := self._drawn(name, placeable, allowed, None, planned)).fits:
                    candidate = other
                    break
            note = self._remark(placeable, candidate.place) or missing if candidate.fits else "no room was found"
        spent = planned.milliseconds + 1e3 * (time.perf_counter() - start)
        if candidate is None or (self.settle and not candidate.fits):
            return Placement(name, draws=0 if candidate is None else candidate.draws, milliseconds=spent, note=note)
        return self._add(placeable, name, candidate, names, make_uid, note, spent)

    def _remark(self, placeable: Placeable, place: NDArray[np.float64]) -> str:
        """What is to be said of a place for what was wanted beside something."""
        if not isinstance(self.proposer, Beside):
            return ""
        gap = float(aside(self.scene, self.proposer.obj, placeable.half, place[None])[0])
        return f"no room beside {self.names[self.proposer.obj]}" if gap > BESIDE + 1e-6 else ""

    def _first(
        self, name: str, placeable: Placeable, allowed: NDArray[np.bool_], early: Proposals | None, planned: Planned
    ) -> _Candidate:
        """The first proposal as it is."""
        proposals = early or next(self._batches(name, placeable, allowed, planned, (1,)))
        return _Candidate(int(proposals.support[0]), proposals.places[0], True, 1)

    def _batches(
        self, name: str, placeable: Placeable, allowed: NDArray[np.bool_], planned: Planned, counts: Sequence[int]
    ) -> Iterator[Proposals]:
        """Proposals, so many at a time: all but the last on the candidate that was planned, if one was."""
        category = self.vocabulary.index(name)
        for step, count in enumerate(counts):
            if planned.candidate is None or (step and step == len(counts) - 1):
                yield self._propose(name, placeable, count, allowed)
            else:
                yield self.proposer.propose_on(  # type: ignore[attr-defined]
                    self.scene, category, placeable, count, self.rng, planned.candidate, planned.row, planned.choice
                )

    def _drawn(
        self, name: str, placeable: Placeable, allowed: NDArray[np.bool_], early: Proposals | None, planned: Planned
    ) -> _Candidate:
        """The first proposal that fits after settling, else the free place nearest to the first of all."""
        category, draws, seen = self.vocabulary.index(name), 0, []
        batches = self._batches(name, placeable, allowed, planned, BATCHES)
        for drawn in batches if early is None else chain([early], batches):
            proposals = self._held(name, placeable, drawn)
            seen.append(proposals)
            places, good = self._settle(name, placeable, proposals)
            if good.any():
                best = int(good.argmax())
                return _Candidate(int(proposals.support[best]), places[best], True, draws + best + 1)
            draws += len(places)
        order = np.concatenate([proposals.support for proposals in seen])
        places = np.concatenate([proposals.places for proposals in seen])
        _, first = np.unique(order, return_index=True)
        for row in np.sort(first)[:SEARCHED]:
            obj = int(order[row])
            found = search(placeable, places[row], category, self._support(name, obj), self.space)
            if found is not None:
                return _Candidate(obj, found, True, draws, searched=True)
        return _Candidate(int(order[0]), places[0], False, draws)

    def _settle(
        self, name: str, placeable: Placeable, proposals: Proposals
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """The proposals' places after settling, and which of them fit."""
        places = proposals.places.copy()
        good = np.zeros(len(places), bool)
        for obj in np.unique(proposals.support):
            mine, support = proposals.support == obj, self._support(name, int(obj))
            places[mine] = rest(placeable, places[mine], support, self.space)
            good[mine] = fitting(placeable, places[mine], self.vocabulary.index(name), support, self.space)
        return places, good

    def _held(self, name: str, placeable: Placeable, proposals: Proposals) -> Proposals:
        """The proposals with the nearest holder where something holds them by its side: which of two walls may be open.

        The model chooses the holder before the place.
        """
        holder, places = proposals.support.copy(), proposals.places
        for obj in np.unique(holder[holder >= 0]) if self.on < 0 else ():
            alike = np.flatnonzero(self.scene.category == self.scene.category[obj])
            if self._support(name, int(obj)).contact != RESTS and len(alike) > 1:
                mine = np.flatnonzero(proposals.support == obj)
                supports = [self._support(name, int(other)) for other in alike]
                holder[mine] = alike[nearest_support(placeable, places[mine], supports, self.space)]
        return Proposals(holder, places)

    def _add(
        self,
        placeable: Placeable,
        name: str,
        candidate: _Candidate,
        names: Names,
        make_uid: UidMaker,
        note: str,
        spent: float,
    ) -> Placement:
        category, world = self.vocabulary.index(name), placeable.world(candidate.place)
        place = candidate.place[None]
        depth = 0.0 if self.settle else float(self.space.depth(placeable, place, category, candidate.obj)[0])
        self.scene.add(category, candidate.obj, world, placeable, candidate.place)
        self.space.add(placeable.boxes_at(place), category)
        own, uid = names.new(name), make_uid(name)
        above, held_by = (self.uids[candidate.obj], self.names[candidate.obj]) if candidate.obj >= 0 else ("", "")
        relation = self._support(name, candidate.obj).prior.relation
        self.additions.append(Addition(placeable.asset, uid, own, above, world, name, relation))
        self.uids.append(uid)
        self.names.append(own)
        self.kinds.append(name)
        return Placement(name, own, uid, held_by, world, depth, candidate.draws, candidate.searched, spent, note)
