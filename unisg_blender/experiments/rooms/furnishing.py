"""Ways to furnish a room: by a model, by a proposer of its own, or by copying the most similar training room."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...generate import Generator
from ...generate.observe.placeable import Placeable
from ...generate.place.scene_extension import Addition, Names, extend, uid_maker
from ...generate.propose.proposer import Proposer
from ...geometry.arrays import Floats, Ints
from ...scene import SceneGraph
from ...spatial.objects import SceneObjects, scene_objects
from .baselines import nearest_room, signature
from .cases import Case, Hole


@dataclass(frozen=True, eq=False)
class Furnished:
    """A furnished room, how many objects were refused, and milliseconds of processor time per object (NaN: none)."""

    scene: SceneGraph
    refused: int
    milliseconds: float


class ByModel:
    """Furnish with a generator; ``settle=False`` takes every first proposal as it is."""

    def __init__(self, model: Generator, settle: bool = True, proposer: Proposer | None = None) -> None:
        self.generator = model if proposer is None else Generator(model.model, proposer)
        self.settle = settle

    def furnish(self, case: Case, seed: int) -> Furnished:
        """The whole room, object by object."""
        start = time.process_time()
        made = self.generator.add(
            case.shell, case.wanted, seed, settle=self.settle, assets=case.assets, behaviour=False
        )
        return Furnished(made.scene, len(made.refused), _per_object(start, case))

    def fill(self, hole: Hole, seed: int, on: str = "", beside: str = "") -> tuple[SceneGraph, int]:
        """One object back into a half-emptied room: the scene and the row, -1 if it was refused.

        ``on`` and ``beside`` are uids of what it is asked for on or beside, "" for anything.
        """
        made = self.generator.add(
            hole.rest, {hole.category: 1}, seed, settle=self.settle, assets={hole.category: [hole.asset]},
            behaviour=False, on=on, beside=beside,
        )  # fmt: skip
        new = made.rows[[made.scene.category_name(row) == hole.category for row in made.rows]]
        return made.scene, int(new[0]) if len(new) else -1


class ByCopying:
    """Furnish as the most similar training room: its k-th scalpel's place for the k-th scalpel here.

    Objects that it has fewer of are refused; ``jitter`` metres of normal noise are added to x and y.
    """

    def __init__(self, training: Sequence[SceneGraph], vocabulary: Sequence[str], jitter: float = 0.0) -> None:
        self.training, self.vocabulary, self.jitter = training, tuple(vocabulary), jitter
        self.signatures = np.array([signature(graph, self.vocabulary) for graph in training])

    def furnish(self, case: Case, seed: int) -> Furnished:
        """The whole room at once."""
        start, rng = time.process_time(), np.random.default_rng(seed)
        best = int(self._order(case.real)[0])
        graph, refused = _copied(case, self.training[best], self.jitter, rng)
        return Furnished(graph, refused, _per_object(start, case))

    def places(self, hole: Hole, draws: int, seed: int) -> list[tuple[Floats, str]]:
        """Places (4,) of one object of the category in each of the most similar rooms, and what it stands on there."""
        rng, found = np.random.default_rng(seed), []
        for number in self._order(hole.rest):
            graph = self.training[number]
            objects = scene_objects(graph, graph.vocabulary)
            rows = _of_category(objects, graph, hole.category)
            if len(rows):
                obj = int(rng.choice(rows))
                place = _place(objects, obj, rng.normal(0, self.jitter, 2) if self.jitter else np.zeros(2))
                above = int(objects.support[obj])
                found.append((place, graph.category_name(int(objects.row[above])) if above >= 0 else ""))
            if len(found) == draws:
                break
        return found

    def _order(self, graph: SceneGraph) -> Ints:
        return nearest_room(signature(graph, self.vocabulary), self.signatures)


def _of_category(objects: SceneObjects, graph: SceneGraph, name: str) -> Ints:
    return (
        np.flatnonzero(objects.category == graph.vocabulary.index(name))
        if name in graph.vocabulary
        else np.zeros(0, np.int64)
    )


def _place(objects: SceneObjects, obj: int, shift: Floats) -> Floats:
    return np.array([*(objects.center[obj, :2] + shift), objects.bottom[obj], objects.yaw[obj]])


def _copied(case: Case, model: SceneGraph, jitter: float, rng: np.random.Generator) -> tuple[SceneGraph, int]:
    objects = scene_objects(model, model.vocabulary)
    names, make_uid = Names(case.shell.name), uid_maker(case.shell, 0)
    floor = next((uid for row, uid in enumerate(case.shell.uid) if case.shell.category_name(row) == "Floor"), "")
    additions, refused = [], 0
    made: dict[int, str] = {}
    for name, shapes in case.assets.items():
        rows = _of_category(objects, model, name)
        refused += max(len(shapes) - len(rows), 0)
        for obj, shape in zip(rows, shapes, strict=False):
            made[int(obj)] = make_uid(name)
            place = _place(objects, obj, rng.normal(0, jitter, 2) if jitter else np.zeros(2))
            world, own = Placeable(shape).world(place), names.new(name)
            relation = objects.relation[obj]
            additions.append((int(obj), Addition(shape, made[int(obj)], own, "", world, name, relation)))
    order = np.argsort([_depth(objects.support, obj) for obj, _ in additions], kind="stable")
    parented = []
    for position in order:
        obj, addition = additions[position]
        above = made.get(int(objects.support[obj]), floor)
        parented.append(replace(addition, parent=above))
    return extend(case.shell, parented, names, make_uid), refused


def _depth(support: Ints, obj: int) -> int:
    depth = 0
    while (obj := int(support[obj])) >= 0 and depth < 32:
        depth += 1
    return depth


class Real:
    """The real room as it is."""

    def furnish(self, case: Case, seed: int) -> Furnished:
        """The case's own room."""
        return Furnished(case.real, 0, float("nan"))


def _per_object(start: float, case: Case) -> float:
    return 1e3 * (time.process_time() - start) / max(sum(case.wanted.values()), 1)


Way = ByModel | ByCopying | Real
