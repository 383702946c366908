"""The generator's table: rooms furnished anew and completed by a model, by other models and by simple rules.

Every test room is emptied down to its structure (floor, walls, doors, windows)
and furnished again with the same objects in the same shapes; see :mod:`.room_measures`
for what is measured, :mod:`.benchmark_rows` for the lines.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...dataset.format.reader import open_dataset
from ...generate.behaviour import behaviour_path
from ...geometry.arrays import Floats
from ...metrics.layout_distances import LayoutSet, mean_pairwise, nearest_room_distances
from ...metrics.layout_features import VERSION as FEATURES_VERSION
from ...metrics.scene_validity import overlapping_categories
from ...metrics.two_sample_test import FOLDS, LEVELS, NOISES, TREES, c2st
from ...runtime.result_cache import Task, array_task, run_all
from ..behaviour.behaviour_benchmark import count_right
from .benchmark_columns import Measured, TableRow, row_of
from .benchmark_rows import (
    LEARNED,
    Data,
    RowSpec,
    benchmark_rows,
    generator_of,
    test_rooms,
    training_rooms,
    vocabulary_of,
)
from .room_measures import VERSION, Arrays, features_of, joined, measure_rooms, split_ragged, training_layouts

LOT, LAYOUT_LOT = 20, 200
"""Rooms that are measured, and training rooms that are read, at a time."""

Progress = Callable[[str, int, int], None]
"""Told what is being done, and how much of how much of it is finished."""


@dataclass(frozen=True)
class TablePlan:
    """What to measure: the model, other models beside it, on which data, how many seeds, first of them, trees.

    The model itself is measured with all seeds, what stands beside it with the first one.
    """

    model: Path
    data: Data
    others: tuple[Path, ...] = ()
    seeds: int = 3
    first_seed: int = 0
    trees: int = TREES

    def rows(self) -> list[RowSpec]:
        """The lines of the table."""
        return benchmark_rows(self.model, self.others, bool(self.data.training))

    def seeds_of(self, spec: RowSpec) -> range:
        """Seeds of a row."""
        drawn = spec.model == str(self.model) and spec.kind == "model"
        return range(self.first_seed, self.first_seed + (self.seeds if drawn else 1))


def compare(plan: TablePlan, folder: Path, jobs: int, progress: Progress = lambda *_: None) -> list[TableRow]:
    """The whole table; ``folder`` keeps results, and a second run with the same plan goes on there."""
    return _Measuring(plan, folder, jobs, progress).table()


Key = tuple[RowSpec, int]
"""A row and a seed."""


class _Measuring:
    """Measures what a plan asks for; every result is kept under the name of all that it depends on."""

    def __init__(self, plan: TablePlan, folder: Path, jobs: int, progress: Progress) -> None:
        self.plan, self.data, self.folder, self.jobs, self.progress = plan, plan.data, folder, jobs, progress
        self.rows = plan.rows()
        paths = {row.model for row in self.rows} | {plan.data.tests, plan.data.training}
        self.sums = {path: _sum_of(path) for path in paths if path}
        self.count = min(plan.data.scenes, len(open_dataset(plan.data.tests)))

    def table(self) -> list[TableRow]:
        """All lines."""
        found = self.rooms()
        judged, variety, acted = self.judged(found), self.varieties(found), self.acted()
        measured = {
            key: Measured(found[key], judged.get(key, {}), *variety[key], acted.get(key, float("nan"))) for key in found
        }
        real = next(spec for spec in self.rows if spec.kind == "real")
        best = next((spec for spec in self.rows if spec.kind == "model" and spec.settle), real)
        lines = {spec: [measured[spec, seed] for seed in self.plan.seeds_of(spec)] for spec in self.rows}
        reference = measured[real, self.plan.first_seed]
        return [row_of(spec.name, lines[spec], reference, lines[best]) for spec in self.rows]

    def task(
        self, call: Callable[..., Arrays], arguments: tuple[Any, ...], row: RowSpec | None = None, **more: Any
    ) -> Task:
        """A task that depends on the data, the versions, perhaps a row, and more."""
        data = [self.sums[self.data.tests], self.sums.get(self.data.training)]
        depends = {"version": VERSION, "features": FEATURES_VERSION, "data": data, **more}
        if row is not None:
            record = asdict(replace(row, name=""))
            depends["row"] = {key: self.sums.get(v, v) if isinstance(v, str) else v for key, v in record.items()}
        return array_task(call, arguments, depends)

    def run(self, step: str, tasks: Sequence[Task]) -> list[Arrays]:
        """The results of tasks, under a name for the progress."""
        return run_all(tasks, self.folder, self.jobs, lambda done: self.progress(step, done, len(tasks)))

    def rooms(self) -> dict[Key, Arrays]:
        """The rooms of all rows and seeds."""
        names, lots = vocabulary_of(self.data), _lots(self.count, LOT)
        (found,) = run_all([self.task(_overlapping, (self.data,))], self.folder, 1)
        allowed = frozenset((names[int(a)], names[int(b)]) for a, b in found["pairs"])
        keys = [(spec, seed) for spec in self.rows for seed in self.plan.seeds_of(spec)]
        tasks = [
            self.task(measure_rooms, (spec, self.data, seed, lot, allowed), spec, seed=seed, lot=lot)
            for spec, seed in keys
            for lot in lots
        ]
        results = iter(self.run("furnishing rooms", tasks))
        return {key: joined([next(results) for _ in lots]) for key in keys}

    def judged(self, found: dict[Key, Arrays]) -> dict[Key, dict[str, Floats]]:
        """Shares of right answers per scene of the classifiers, by row and by "level noise"."""
        real, first, trees = found[self.rows[0], self.plan.first_seed], self.plan.first_seed, self.plan.trees
        keys = [(spec, seed) for spec in self.rows[1:] for seed in self.plan.seeds_of(spec)]
        judges, names = [(level, noise) for level in LEVELS for noise in NOISES], vocabulary_of(self.data)
        tasks = [
            self.task(
                told_apart, (real, found[spec, seed], level, noise, names, seed, trees), spec, seed=seed, level=level,
                noise=noise, trees=trees, folds=FOLDS, real=first, scenes=len(real["counts"]),
            )
            for spec, seed in keys
            for level, noise in judges
        ]  # fmt: skip
        results = iter(self.run("training classifiers", tasks))
        return {key: {f"{level} {noise}": next(results)["right"] for level, noise in judges} for key in keys}

    def acted(self) -> dict[Key, float]:
        """Recall of the actions of the model's settled row, by seed; nothing if no behaviour lies beside it."""
        model, beside = str(self.plan.model), behaviour_path(self.plan.model)
        own = next((spec for spec in self.rows if spec.model == model and spec.completes), None)
        if own is None or not beside.is_file():
            return {}
        seeds, lots, sums = self.plan.seeds_of(own), _lots(self.count, LOT), [self.sums[model], _sum_of(str(beside))]
        tasks = [
            self.task(behaviour_of_rooms, (own, self.data, seed, lot), model=sums, seed=seed, lot=lot)
            for seed in seeds
            for lot in lots
        ]
        results = self.run("behaviour", tasks)
        totals = np.array([part["counts"] for part in results]).reshape(len(seeds), len(lots), 3).sum(axis=1)
        return {(own, seed): right / wanted for seed, (wanted, right, _) in zip(seeds, totals, strict=True) if wanted}

    def varieties(self, found: dict[Key, Arrays]) -> dict[Key, tuple[Floats, float]]:
        """Of each row and seed: distances to the nearest training rooms, and the mean distance between its rooms."""
        categories, training = len(vocabulary_of(self.data)), self.training()
        tasks = [
            self.task(
                variety_of, (_only_layouts(arrays), _only_layouts(training), categories), spec, seed=seed,
                scenes=len(arrays["counts"]), training=len(training["counts"]),
            )
            for (spec, seed), arrays in found.items()
        ]  # fmt: skip
        results = self.run("comparing layouts", tasks)
        return {key: (part["nearest"], float(part["pairwise"])) for key, part in zip(found, results, strict=True)}

    def training(self) -> Arrays:
        """Layouts of all training rooms, joined; none without a training set."""
        if not self.data.training:
            return {"layout": np.zeros((0, 4)), "counts": np.zeros((0, 1))}
        lots = _lots(len(open_dataset(self.data.training)), LAYOUT_LOT)
        tasks = [self.task(training_layouts, (self.data, lot), lot=lot) for lot in lots]
        return joined(self.run("reading training rooms", tasks))


def _lots(count: int, size: int) -> list[tuple[int, ...]]:
    """Numbers up to a count in lots of a size."""
    return [tuple(range(start, min(start + size, count))) for start in range(0, count, size)]


def _overlapping(data: Data) -> Arrays:
    names = vocabulary_of(data)
    pairs = overlapping_categories(training_rooms(data, LEARNED) or test_rooms(data), parts=True)
    known = [(names.index(a), names.index(b)) for a, b in sorted(pairs) if a in names and b in names]
    return {"pairs": np.array(known, np.float64).reshape(-1, 2)}


def told_apart(
    real: Arrays, made: Arrays, level: str, noise: float, vocabulary: tuple[str, ...], seed: int, trees: int
) -> Arrays:
    """:func:`~...metrics.two_sample_test.c2st` of measured rooms."""
    right = c2st(features_of(real), features_of(made), level, noise, vocabulary, seed, trees)
    return {"right": right}


def behaviour_of_rooms(spec: RowSpec, data: Data, seed: int, numbers: Sequence[int]) -> Arrays:
    """:func:`~..behaviour.behaviour_benchmark.count_right` of some test rooms."""
    rooms = [test_rooms(data)[number] for number in numbers]
    return {"counts": count_right(generator_of(spec.model), rooms, 1000 * seed + numbers[0])}


def _only_layouts(found: Arrays) -> Arrays:
    return {name: found[name] for name in ("layout", "counts")}


def variety_of(found: Arrays, training: Arrays, categories: int) -> Arrays:
    """Distances of rooms to the nearest training rooms, NaN without any, and the mean distance between the rooms."""
    layouts, rooms = _layouts(found), LayoutSet(_layouts(training), categories)
    near = nearest_room_distances(layouts, rooms) if len(training["counts"]) else np.full(len(layouts), np.nan)
    return {"nearest": near, "pairwise": np.array(mean_pairwise(layouts, categories))}


def _layouts(found: Arrays) -> list[NDArray[np.float32]]:
    return [layout.astype(np.float32) for layout in split_ragged(found["layout"], len(found["counts"]))]


def _sum_of(path: str) -> str:
    """What a model's file or a dataset holds, as a checksum."""
    if Path(path).is_dir():
        shards = [shard["sha256"] for shard in open_dataset(path).manifest["shards"]]
        return hashlib.sha256("".join(shards).encode()).hexdigest()
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()
