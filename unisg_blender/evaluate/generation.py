"""How good are generated scenes: rooms furnished anew by a model and by simple rules, and measured.

Every test room is emptied down to its structure (floor, walls, doors, windows)
and furnished again with the same things in the same shapes. What results is
measured by :mod:`.scene_metrics`; category pairs that overlap in the real rooms
are left out of the collisions.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..dataset.assets import STRUCTURE, Asset, thing_of
from ..generate import Generator
from ..generate.extend import Addition, Names, extend, uid_maker
from ..generate.pieces import Piece
from ..generate.proposals import Proposer, Scene
from ..generate.things import things_of
from ..scene import SceneGraph, take, world_matrices
from .baselines import GaussianProposer, nearest_scene
from .scene_metrics import measure_scene, overlapping_categories, summarise


@dataclass(frozen=True, eq=False)
class Case:
    """A room to furnish: the real one, its shell, and the things to put in, by category."""

    real: SceneGraph
    shell: SceneGraph
    assets: dict[str, list[Asset]]
    wanted: dict[str, int]


@dataclass(frozen=True)
class Row:
    """One line of the table: shares of objects in 0..1, milliseconds per object (median), support accuracy."""

    name: str
    scenes: int
    objects: int
    colliding: float
    off_support: float
    outside: float
    refused: float
    same_support: float
    milliseconds: float

    def to_record(self) -> dict[str, Any]:
        """JSON-ready."""
        return {name: round(value, 4) if isinstance(value, float) else value for name, value in self.__dict__.items()}


def case_of(graph: SceneGraph, known: Sequence[str]) -> Case | None:
    """The test case of a room, None if there is nothing to move; what the model does not know stays where it is."""
    names = np.array([graph.category_name(row) for row in range(len(graph))])
    movable = np.isin(names, known) & ~np.isin(names, STRUCTURE) & (graph.mesh >= 0)
    gone = movable.copy()
    for row in range(len(graph)):
        above = graph.parent[row]
        gone[row] |= above >= 0 and gone[above]
    if not movable.any():
        return None
    assets: dict[str, list[Asset]] = {}
    for row in np.flatnonzero(movable):
        assets.setdefault(str(names[row]), []).append(thing_of(graph, int(row)))
    shell = take(graph, np.flatnonzero(~gone))
    kept = {name: value for name, value in shell.components.items() if name == "relations"}
    return Case(graph, shell.replace(components=kept), assets, {name: len(group) for name, group in assets.items()})


Furnish = Callable[[Case, int], tuple[SceneGraph, int, list[float]]]
"""Furnishes a case with a seed: the scene, objects refused, milliseconds of each object."""


def by_model(model: Generator, proposer: Proposer | None = None, settle: bool = True) -> Furnish:
    """Furnish with a generator, its model's proposals replaced by another ``proposer`` if there is one."""
    generator = model if proposer is None else Generator(model.model, proposer)

    def furnish(case: Case, seed: int) -> tuple[SceneGraph, int, list[float]]:
        result = generator.add(case.shell, case.wanted, seed, settle=settle, assets=case.assets)
        return result.scene, len(result.refused), [placement.milliseconds for placement in result.objects]

    return furnish


def by_copying(training: Sequence[SceneGraph], vocabulary: Sequence[str], jitter: float = 0.0) -> Furnish:
    """Furnish as the most similar training room: its k-th scalpel's place for the k-th scalpel here.

    Things that it has fewer of are refused; ``jitter`` metres of normal noise are added to x and y.
    """
    scenes = [_scene_of(graph, vocabulary) for graph in training]

    def furnish(case: Case, seed: int) -> tuple[SceneGraph, int, list[float]]:
        start, rng = time.perf_counter(), np.random.default_rng(seed)
        best = nearest_scene(_scene_of(case.real, vocabulary), scenes, len(vocabulary))
        graph, refused = _copied(case, training[best], jitter, rng)
        return graph, refused, [1e3 * (time.perf_counter() - start) / max(sum(case.wanted.values()), 1)]

    return furnish


def _scene_of(graph: SceneGraph, vocabulary: Sequence[str]) -> Scene:
    things = things_of(graph, vocabulary)
    return Scene.of(things, world_matrices(graph)[things.row])


def _copied(case: Case, model: SceneGraph, jitter: float, rng: np.random.Generator) -> tuple[SceneGraph, int]:
    things = things_of(model, model.vocabulary)
    names, make_uid = Names(case.shell.name), uid_maker(case.shell, 0)
    floor = next((uid for row, uid in enumerate(case.shell.uid) if case.shell.category_name(row) == "Floor"), "")
    additions, refused = [], 0
    made: dict[int, str] = {}
    for name, shapes in case.assets.items():
        rows = np.flatnonzero(things.category == model.vocabulary.index(name)) if name in model.vocabulary else ()
        refused += max(len(shapes) - len(rows), 0)
        for thing, shape in zip(rows, shapes, strict=False):
            made[int(thing)] = make_uid(name)
            shift = rng.normal(0, jitter, 2) if jitter else np.zeros(2)
            place = np.array([*(things.center[thing, :2] + shift), things.bottom[thing], things.yaw[thing]])
            world, own = Piece(shape).world(place), names.new(name)
            relation = things.relation[thing]
            additions.append((int(thing), Addition(shape, made[int(thing)], own, "", world, name, relation)))
    order = np.argsort([_depth(things.support, thing) for thing, _ in additions], kind="stable")
    parented = []
    for position in order:
        thing, addition = additions[position]
        above = made.get(int(things.support[thing]), floor)
        parented.append(replace(addition, parent=above))
    return extend(case.shell, parented, names, make_uid), refused


def _depth(support: np.ndarray, thing: int) -> int:
    depth = 0
    while (thing := int(support[thing])) >= 0 and depth < 32:
        depth += 1
    return depth


def measure(name: str, cases: Sequence[Case], furnish: Furnish, allowed: Iterable[tuple[str, str]], seed: int) -> Row:
    """Furnish all cases and measure what comes out."""
    allowed, reports, refused, spent, same = set(allowed), [], 0, [], []
    for number, case in enumerate(cases):
        scene, missing, times = furnish(case, seed + number)
        reports.append(measure_scene(scene, allowed=allowed))
        refused += missing
        spent += times
        same.append(same_supports(scene, case))
    table = summarise(reports)
    asked = sum(sum(case.wanted.values()) for case in cases)
    return Row(
        name, len(cases), int(table["objects"]), table["colliding"], table["off_support"], table["outside"],
        refused / max(asked, 1), float(np.mean(same)), float(np.median(spent)) if spent else 0.0,
    )  # fmt: skip


def same_supports(scene: SceneGraph, case: Case) -> float:
    """How far the numbers of (category, category of its support) agree with the real room: overlap in 0..1."""
    one, two = _support_counts(scene), _support_counts(case.real)
    shared = sum(min(one[key], two[key]) for key in one.keys() & two.keys())
    return shared / max(sum(two.values()), 1)


def _support_counts(graph: SceneGraph) -> dict[tuple[str, str], int]:
    things = things_of(graph, graph.vocabulary)
    found: dict[tuple[str, str], int] = {}
    for thing, row in enumerate(things.row):
        above = things.support[thing]
        kind = graph.category_name(int(things.row[above])) if above >= 0 else ""
        key = (graph.category_name(int(row)), kind)
        if key[0] not in STRUCTURE:
            found[key] = found.get(key, 0) + 1
    return found


def compare(
    generator: Generator,
    tests: Sequence[SceneGraph],
    training: Sequence[SceneGraph],
    seed: int,
    progress: Callable[[str], None] = lambda _: None,
) -> list[Row]:
    """The table: real rooms, the model raw and settled, and (with ``training`` rooms) the baselines."""
    vocabulary = generator.categories
    cases = [case for graph in tests if (case := case_of(graph, vocabulary)) is not None]
    allowed = overlapping_categories(training or tests, parts=True)
    runs: list[tuple[str, Furnish]] = [
        ("real", lambda case, seed: (case.real, 0, [])),
        ("model, raw", by_model(generator, settle=False)),
        ("model, settled", by_model(generator)),
    ]
    if training:
        scenes = [_scene_of(graph, vocabulary) for graph in training]
        gaussian = GaussianProposer(scenes)
        runs += [
            ("category mean, raw", by_model(generator, GaussianProposer(scenes, 0.0), settle=False)),
            ("category Gaussian, raw", by_model(generator, gaussian, settle=False)),
            ("category Gaussian, settled", by_model(generator, gaussian)),
            ("nearest room copied", by_copying(training, vocabulary)),
            ("nearest room copied, 10 cm jitter", by_copying(training, vocabulary, 0.1)),
        ]
    rows = []
    for name, furnish in runs:
        progress(name)
        rows.append(measure(name, cases, furnish, allowed, seed))
    return rows
