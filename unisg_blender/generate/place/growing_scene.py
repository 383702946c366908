"""A scene while objects are added: what a model sees of it, the space that is taken up, and what was added."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...scene import SceneGraph
from ...spatial.objects import find_object
from ...spatial.structure.doorways import doorways
from ...spatial.structure.room_objects import room_objects
from ..observe.contract import Contract
from ..observe.facing import facing
from ..observe.observed_scene import ObservedScene
from ..observe.placeable import Placeable
from ..observe.support_priors import AT_SIDE, INSIDE, RESTS, SupportPrior
from ..propose.place_sampling import USUAL
from ..propose.proposer import Query
from .free_space import NOBODY, FreeSpace
from .inner_levels import inner_levels
from .scene_extension import Addition, Names, UidMaker
from .settle_geometry import Support
from .spanning_objects import fit_for
from .ways_kept import WaysKept

FLUSH = 5e-4
"""Metres between what is fixed to a wall and its face, which is where the room ends."""


@dataclass(frozen=True)
class Label:
    """How an object of the scene is called, and whether it is a floor."""

    uid: str
    name: str
    floor: bool


@dataclass(frozen=True, eq=False)
class Target:
    """An object to be placed: number of its category, its shape, and whether the shape was ``chosen`` by the user."""

    category: int
    placeable: Placeable
    chosen: bool = False

    @property
    def footprint(self) -> float:
        """Area that its upright box covers, m2."""
        return float(4 * self.placeable.half[:2].prod())


class GrowingScene:
    """The objects of a scene by number, those that are added last; categories are numbers of the model's vocabulary."""

    def __init__(
        self, graph: SceneGraph, contract: Contract, near: Floats | None = None, alone: bool = False
    ) -> None:  # see :func:`room_objects`
        room = room_objects(graph, contract.vocabulary, near, alone)
        self.vocabulary, self.tables = contract.vocabulary, contract.tables
        movable = ~self.tables.structural[room.objects.category]
        objects = facing(room.objects, graph, movable, room.outline)
        self.observed = ObservedScene.of(objects, room.world)
        self.space = FreeSpace(objects.parts, objects.owner, objects.category, room.outline, self.tables)
        self.space.take_up(room.obstacles, NOBODY)
        if room.structure is not None:
            self.space.take_up(doorways(room.structure.rooms), NOBODY)
        self.ways = WaysKept(room, movable)
        self.sampling = USUAL
        self.labels = [
            Label(graph.uid[row], graph.name[row], bool(floor))
            for row, floor in zip(objects.row, room.floor, strict=True)
        ]
        self.additions: list[Addition] = []
        self.graph, self._rows = graph, objects.row
        self._shape_of: dict[int, tuple[SceneGraph, int, Floats]] = {}
        self._supports: dict[tuple[int, int], Support] = {}

    def find(self, graph: SceneGraph, text: str) -> int:
        """The number of the object with a uid or name; UniSGError if it is not one object."""
        return find_object(graph, [label.uid for label in self.labels], text)

    def usual_holders(self, category: int) -> Bools:
        """Which objects (K,) usually hold a category."""
        kinds = self.observed.category
        return self.tables.usual[category][kinds] & (kinds >= 0)

    def holders(self, category: int) -> tuple[Bools, str]:
        """Which objects may hold a category, and what to say where none of the usual ones is there: then the floor."""
        usual = self.usual_holders(category)
        if usual.any() or self.tables.usual[category, -1]:
            return usual, ""
        names = [self.vocabulary[kind] for kind in self.tables.supports.get(category, ())]
        return self.observed.category == self.tables.floor, f"no {' or '.join(names[:3])} in the scene"

    def query(self, target: Target, allowed: Bools, coming: Mapping[int, int]) -> Query:
        """What to ask a model about an object; of what spans, only holders from which it reaches across are allowed."""
        allowed = fit_for(target.category, target.placeable.half, self.observed, allowed, self.tables)
        return Query(self.observed, target.category, target.placeable, allowed, coming, self.sampling)

    def support(self, category: int, obj: int) -> Support:
        """How an object (-1: the ground) holds a category."""
        if (category, obj) not in self._supports:
            kind = int(self.observed.category[obj]) if obj >= 0 else -1
            known = obj < 0 or kind >= 0
            prior = self.tables.supports.get(category, {}).get(kind) if known else None
            if prior is not None and prior.contact == AT_SIDE:
                prior = replace(prior, gap=max(prior.gap, FLUSH))
            self._supports[category, obj] = Support(
                obj, prior or SupportPrior("", 0, RESTS), self.space.parts_of(obj),
                obj >= 0 and self.labels[obj].floor, bool(self.tables.structural[category]),
                self._levels(obj, prior.relation if prior else ""),
            )  # fmt: skip
        return self._supports[category, obj]

    def _levels(self, obj: int, relation: str) -> Floats:
        """Heights of what is level in an object, for what is said to be inside it; none for anything else."""
        if relation != INSIDE or obj < 0:
            return np.zeros(0)
        if obj in self._shape_of:
            graph, row, world = self._shape_of[obj]
        else:
            graph, row = self.graph, int(self._rows[obj])
            world = graph.world[row]
        return inner_levels(graph.meshes[graph.mesh[row]], world) if graph.mesh[row] >= 0 else np.zeros(0)

    def add(self, target: Target, support: int, place: Floats, names: Names, make_uid: UidMaker) -> Addition:
        """Put an object at a place (4,) on a support (-1: the ground)."""
        category, world, name = target.category, target.placeable.world(place), self.vocabulary[target.category]
        self._shape_of[len(self.labels)] = target.placeable.asset.graph, 0, world
        self.observed.add(category, support, world, target.placeable, place)
        self.space.add(target.placeable.boxes_at(place[None]), category)
        if not self.tables.structural[category]:
            self.ways.add(target.placeable, place)
        own = names.new(name)
        label = Label(make_uid(name), own, category == self.tables.floor)
        above = self.labels[support].uid if support >= 0 else ""
        relation = self.support(category, support).prior.relation
        self.additions.append(Addition(target.placeable.asset, label.uid, label.name, above, world, name, relation))
        self.labels.append(label)
        return self.additions[-1]
