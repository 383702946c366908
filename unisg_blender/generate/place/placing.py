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
from ...spatial.floor_plan import FLOOR, room_outline
from ...spatial.objects import find_object, scene_objects
from ...spatial.structure import STRUCTURE
from ..observe.contract import Contract
from ..observe.proposals import Proposals, Proposer, Scene
from ..observe.support_priors import RESTS, Habit
from ..propose.anchor_proposer import AnchorProposer
from ..propose.requests import BESIDE, Beside, On, aside, covers
from ..results import Placement
from ..shape_library import Library
from .free_space import Space
from .placeable import Piece
from .planning import Planned, Planner, usual_kinds
from .scene_extension import Addition, Names, UidMaker
from .settling import Support, fitting, nearest_support, rest, search
from .spanning_objects import fit_for, reaches

BATCHES = (8, 24, 28)
"""Proposals asked for at a time, until one fits: first on the spot that was planned, then on any."""

OTHER_SHAPES = 2
"""Further shapes to try when the first one finds no place."""

SEARCHED = 4
"""Supports whose whole surface is searched when no proposal fits."""


@dataclass(frozen=True, eq=False)
class _Spot:
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
        self.habits, self.vocabulary = self.contract.habits, self.contract.vocabulary
        self.graph, self.rng, self.settle = graph, rng, settle
        objects = scene_objects(graph, self.vocabulary)
        self.scene = Scene.of(objects, world_matrices(graph)[objects.row])
        self.uids = [graph.uid[row] for row in objects.row]
        self.names = [graph.name[row] for row in objects.row]
        self.kinds = [graph.category_name(row) for row in objects.row]
        has_floor = FLOOR in self.kinds and (graph.mesh[objects.row] >= 0)[self.kinds.index(FLOOR)]
        outline = room_outline(graph) if has_floor else None
        self.space = Space(objects.parts, objects.owner, objects.category, outline, self.habits, self.vocabulary)
        self.additions: list[Addition] = []
        self.coming = Counter(wanted)
        self.given: set[int] = set()
        self.usual = usual_kinds(self.vocabulary, self.habits)
        self.floor = self.vocabulary.index(FLOOR) if FLOOR in self.vocabulary else -2
        self.on = -1
        self.pieces = self._pieces(wanted, assets or {})
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
        """The objects in the order of placing, with the spots planned for them; level by level, as the scene grows."""
        if self.on >= 0 or not isinstance(self.proposer, AnchorProposer):
            yield from (Planned(number) for number in range(len(wanted)))
            return
        planner = Planner(self.proposer, self.scene, self.contract, self.pieces, self.usual, self.rng)
        yield from planner.order(wanted, self.coming)

    def _pieces(self, wanted: Sequence[str], assets: Mapping[str, Sequence[Asset]]) -> list[Piece]:
        """A shape for each object, in order."""
        left = {name: [Piece(asset) for asset in shapes] for name, shapes in assets.items()}
        pieces = []
        for number, name in enumerate(wanted):
            if left.get(name):
                self.given.add(number)
                pieces.append(left[name].pop(0))
            else:
                pieces.append(self._shape(name))
        return pieces

    def _shape(self, name: str) -> Piece:
        """A shape at random; of what spans, one that reaches across in this room, if there is any."""
        if name not in self.habits.spans:
            return self.library.piece(name, self.graph, self.rng)
        holders = self._allowed(name)[0]
        return self.library.piece(name, self.graph, self.rng, lambda piece: reaches(self.scene, holders, piece.half))

    def propose_all(self, wanted: Sequence[str]) -> list[Proposals]:
        """First proposals for all objects, none of them seeing another."""
        return [
            self._propose(name, piece, BATCHES[0], self._allowed(name)[0])
            for name, piece in zip(wanted, self.pieces, strict=True)
        ]

    def _propose(self, name: str, piece: Piece, count: int, allowed: NDArray[np.bool_]) -> Proposals:
        coming = {self.vocabulary.index(kind): number for kind, number in self.coming.items() if number}
        allowed = fit_for(name, piece.half, self.scene, allowed, self.habits)
        return self.proposer.propose(self.scene, self.vocabulary.index(name), piece, count, self.rng, allowed, coming)

    def _allowed(self, name: str) -> tuple[NDArray[np.bool_], str]:
        """Which objects may hold a category, and what to say where none of the usual ones is there."""
        if self.on >= 0:
            return covers(self.scene, self.on) | (np.arange(len(self.scene.category)) == self.on), ""
        usual = self.usual[self.vocabulary.index(name)]
        allowed = usual[self.scene.category]
        if allowed.any() or usual[-1]:
            return allowed & (self.scene.category >= 0), ""
        kinds = [habit.support for habit in self.habits.supports[name]]
        return self.scene.category == self.floor, f"no {' or '.join(kinds[:3])} in the scene"

    def _support(self, name: str, obj: int) -> Support:
        if (name, obj) not in self._resting:
            kind = self.kinds[obj] if obj >= 0 else ""
            habit = self.habits.habit(name, kind) or Habit(kind, 0, RESTS)
            self._resting[name, obj] = Support(obj, habit, self.space.surfaces(obj), kind == FLOOR, name in STRUCTURE)
        return self._resting[name, obj]

    def place(
        self, planned: Planned, name: str, names: Names, make_uid: UidMaker, early: Proposals | None
    ) -> Placement:
        """Find a place for an object and add it, or say why there is none."""
        start, number = time.perf_counter(), planned.number
        self.coming[name] -= 1
        piece = self.pieces[number]
        allowed, missing = self._allowed(name)
        spot, note = None, missing
        if missing and self.habits.supports[name][0].contact != RESTS:
            note = f"{missing} to hold it"
        elif not self.settle:
            spot = self._first(name, piece, allowed, early, planned)
        else:
            spot = self._drawn(name, piece, allowed, early, planned)
            for _ in range(0 if number in self.given or spot.fits else OTHER_SHAPES):
                piece = self._shape(name)
                if (other := self._drawn(name, piece, allowed, None, planned)).fits:
                    spot = other
                    break
            note = self._remark(piece, spot.place) or missing if spot.fits else "no room was found"
        spent = planned.milliseconds + 1e3 * (time.perf_counter() - start)
        if spot is None or (self.settle and not spot.fits):
            return Placement(name, draws=0 if spot is None else spot.draws, milliseconds=spent, note=note)
        return self._add(piece, name, spot, names, make_uid, note, spent)

    def _remark(self, piece: Piece, place: NDArray[np.float64]) -> str:
        """What is to be said of a place for what was wanted beside something."""
        if not isinstance(self.proposer, Beside):
            return ""
        gap = float(aside(self.scene, self.proposer.obj, piece.half, place[None])[0])
        return f"no room beside {self.names[self.proposer.obj]}" if gap > BESIDE + 1e-6 else ""

    def _first(
        self, name: str, piece: Piece, allowed: NDArray[np.bool_], early: Proposals | None, planned: Planned
    ) -> _Spot:
        """The first proposal as it is."""
        proposals = early or next(self._batches(name, piece, allowed, planned, (1,)))
        return _Spot(int(proposals.support[0]), proposals.places[0], True, 1)

    def _batches(
        self, name: str, piece: Piece, allowed: NDArray[np.bool_], planned: Planned, counts: Sequence[int]
    ) -> Iterator[Proposals]:
        """Proposals, so many at a time: all but the last on the spot that was planned, if one was."""
        category = self.vocabulary.index(name)
        for step, count in enumerate(counts):
            if planned.spot is None or (step and step == len(counts) - 1):
                yield self._propose(name, piece, count, allowed)
            else:
                yield self.proposer.propose_on(  # type: ignore[attr-defined]
                    self.scene, category, piece, count, self.rng, planned.spot, planned.row, planned.choice
                )

    def _drawn(
        self, name: str, piece: Piece, allowed: NDArray[np.bool_], early: Proposals | None, planned: Planned
    ) -> _Spot:
        """The first proposal that fits after settling, else the free place nearest to the first of all."""
        category, draws, seen = self.vocabulary.index(name), 0, []
        batches = self._batches(name, piece, allowed, planned, BATCHES)
        for drawn in batches if early is None else chain([early], batches):
            proposals = self._held(name, piece, drawn)
            seen.append(proposals)
            places, good = self._settle(name, piece, proposals)
            if good.any():
                best = int(good.argmax())
                return _Spot(int(proposals.support[best]), places[best], True, draws + best + 1)
            draws += len(places)
        order = np.concatenate([proposals.support for proposals in seen])
        places = np.concatenate([proposals.places for proposals in seen])
        _, first = np.unique(order, return_index=True)
        for row in np.sort(first)[:SEARCHED]:
            obj = int(order[row])
            found = search(piece, places[row], category, self._support(name, obj), self.space)
            if found is not None:
                return _Spot(obj, found, True, draws, searched=True)
        return _Spot(int(order[0]), places[0], False, draws)

    def _settle(self, name: str, piece: Piece, proposals: Proposals) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """The proposals' places after settling, and which of them fit."""
        places = proposals.places.copy()
        good = np.zeros(len(places), bool)
        for obj in np.unique(proposals.support):
            mine, support = proposals.support == obj, self._support(name, int(obj))
            places[mine] = rest(piece, places[mine], support, self.space)
            good[mine] = fitting(piece, places[mine], self.vocabulary.index(name), support, self.space)
        return places, good

    def _held(self, name: str, piece: Piece, proposals: Proposals) -> Proposals:
        """The proposals with the nearest holder where something holds them by its side: which of two walls may be open.

        The model chooses the holder before the place.
        """
        holder, places = proposals.support.copy(), proposals.places
        for obj in np.unique(holder[holder >= 0]) if self.on < 0 else ():
            alike = np.flatnonzero(self.scene.category == self.scene.category[obj])
            if self._support(name, int(obj)).contact != RESTS and len(alike) > 1:
                mine = np.flatnonzero(proposals.support == obj)
                supports = [self._support(name, int(other)) for other in alike]
                holder[mine] = alike[nearest_support(piece, places[mine], supports, self.space)]
        return Proposals(holder, places)

    def _add(
        self, piece: Piece, name: str, spot: _Spot, names: Names, make_uid: UidMaker, note: str, spent: float
    ) -> Placement:
        category, world = self.vocabulary.index(name), piece.world(spot.place)
        place = spot.place[None]
        depth = 0.0 if self.settle else float(self.space.depth(piece, place, category, spot.obj)[0])
        self.scene.add(category, spot.obj, world, piece, spot.place)
        self.space.add(piece.boxes_at(place), category)
        own, uid = names.new(name), make_uid(name)
        above, held_by = (self.uids[spot.obj], self.names[spot.obj]) if spot.obj >= 0 else ("", "")
        relation = self._support(name, spot.obj).habit.relation
        self.additions.append(Addition(piece.asset, uid, own, above, world, name, relation))
        self.uids.append(uid)
        self.names.append(own)
        self.kinds.append(name)
        return Placement(name, own, uid, held_by, world, depth, spot.draws, spot.searched, spent, note)
