"""The generator's table: rooms furnished anew and completed by a model, by other models and by simple rules.

Every test room is emptied down to its structure (floor, walls, doors, windows)
and furnished again with the same objects in the same shapes; see :mod:`.room_measures`
for what is measured, :mod:`.table_rows` for the lines.
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
from ...metrics.layout_distances import LayoutSet, mean_pairwise, nearest_room_distances
from ...metrics.layout_features import VERSION as FEATURES_VERSION
from ...metrics.scene_validity import overlapping_categories
from ...metrics.two_sample_test import FOLDS, LEVELS, NOISES, TREES, c2st
from ...runtime.result_cache import array_task, run_all
from ..behaviour.behaviour_benchmark import count_right
from .room_measures import VERSION, Arrays, features_of, joined, measure_rooms, split_ragged, training_layouts
from .row_summary import Measured, TableRow, row_of
from .table_rows import LEARNED, Data, RowSpec, generator_of, table_rows, test_rooms, training_rooms, vocabulary_of

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
        return table_rows(self.model, self.others, bool(self.data.training))

    def seeds_of(self, spec: RowSpec) -> range:
        """Seeds of a row."""
        return range(self.first_seed, self.first_seed + (self.seeds if spec.model == str(self.model) else 1))


def compare(plan: TablePlan, folder: Path, jobs: int, progress: Progress = lambda *_: None) -> list[TableRow]:
    """The whole table; ``folder`` keeps results, and a second run with the same plan goes on there."""
    rows = plan.rows()
    sums = {
        path: _sum_of(path)
        for path in {row.model for row in rows if row.model} | {plan.data.tests, plan.data.training}
        if path
    }
    depends = {
        "version": VERSION,
        "features": FEATURES_VERSION,
        "data": [sums[plan.data.tests], sums.get(plan.data.training)],
    }
    found = _measured(plan, rows, depends, sums, folder, jobs, progress)
    judged = _judged(plan, rows, found, depends, sums, folder, jobs, progress)
    layouts = _training_layouts(plan, depends, folder, jobs, progress)
    variety = _varieties(plan, found, layouts, depends, sums, folder, jobs, progress)
    acted = _acted(plan, rows, depends, sums, folder, jobs, progress)
    real = next(spec for spec in rows if spec.kind == "real")
    measured = {
        key: Measured(found[key], judged.get(key, {}), *variety[key], acted.get(key, float("nan"))) for key in found
    }
    best = next((spec for spec in rows if spec.kind == "model" and spec.settle), real)
    reference, ours = measured[real, plan.first_seed], [measured[best, seed] for seed in plan.seeds_of(best)]
    return [row_of(spec.name, [measured[spec, seed] for seed in plan.seeds_of(spec)], reference, ours) for spec in rows]


Key = tuple[RowSpec, int]


def _measured(
    plan: TablePlan, rows: Sequence[RowSpec], depends: dict[str, Any], sums: dict[str, str], folder: Path, jobs: int,
    progress: Progress,
) -> dict[Key, Arrays]:  # fmt: skip
    """The rooms of all rows and seeds."""
    allowed = _allowed(plan.data, depends, folder)
    count = min(plan.data.scenes, len(open_dataset(plan.data.tests)))
    lots = [range(start, min(start + LOT, count)) for start in range(0, count, LOT)]
    keys = [(spec, seed) for spec in rows for seed in plan.seeds_of(spec)]
    tasks = [
        array_task(
            measure_rooms, (spec, plan.data, seed, tuple(lot), allowed),
            depends | {"row": _named(asdict(replace(spec, name="")), sums), "seed": seed, "lot": list(lot)},
        )
        for spec, seed in keys
        for lot in lots
    ]  # fmt: skip
    results = run_all(tasks, folder, jobs, lambda done: progress("furnishing rooms", done, len(tasks)))
    each = len(lots)
    return {key: joined(results[each * number : each * (number + 1)]) for number, key in enumerate(keys)}


def _allowed(data: Data, depends: dict[str, Any], folder: Path) -> frozenset[tuple[str, str]]:
    """Category pairs that overlap in real rooms."""
    task = array_task(_overlapping, (data,), depends)
    names = vocabulary_of(data)
    (found,) = run_all([task], folder, 1)
    return frozenset((names[int(a)], names[int(b)]) for a, b in found["pairs"])


def _overlapping(data: Data) -> Arrays:
    names = vocabulary_of(data)
    pairs = overlapping_categories(training_rooms(data, LEARNED) or test_rooms(data), parts=True)
    known = [(names.index(a), names.index(b)) for a, b in sorted(pairs) if a in names and b in names]
    return {"pairs": np.array(known, np.float64).reshape(-1, 2)}


def _judged(
    plan: TablePlan, rows: Sequence[RowSpec], found: dict[Key, Arrays], depends: dict[str, Any], sums: dict[str, str],
    folder: Path, jobs: int, progress: Progress,
) -> dict[Key, dict[str, NDArray[np.float64]]]:  # fmt: skip
    """Shares of right answers per scene of the classifiers, by row and by "level noise"."""
    real = found[rows[0], plan.first_seed]
    keys = [(spec, seed) for spec in rows[1:] for seed in plan.seeds_of(spec)]
    judges = [(level, noise) for level in LEVELS for noise in NOISES]
    tasks = [
        array_task(
            told_apart, (real, found[key], level, noise, vocabulary_of(plan.data), key[1], plan.trees),
            depends | {
                "row": _named(asdict(replace(key[0], name="")), sums), "seed": key[1], "level": level, "noise": noise,
                "trees": plan.trees, "folds": FOLDS, "real": plan.first_seed, "scenes": len(real["counts"]),
            },
        )
        for key in keys
        for level, noise in judges
    ]  # fmt: skip
    results = iter(run_all(tasks, folder, jobs, lambda done: progress("training classifiers", done, len(tasks))))
    return {key: {f"{level} {noise}": next(results)["right"] for level, noise in judges} for key in keys}


def told_apart(
    real: Arrays, made: Arrays, level: str, noise: float, vocabulary: tuple[str, ...], seed: int, trees: int
) -> Arrays:
    """:func:`~...metrics.two_sample_test.c2st` of measured rooms."""
    right = c2st(features_of(real), features_of(made), level, noise, vocabulary, seed, trees)
    return {"right": right}


def _acted(
    plan: TablePlan, rows: Sequence[RowSpec], depends: dict[str, Any], sums: dict[str, str], folder: Path, jobs: int,
    progress: Progress,
) -> dict[Key, float]:  # fmt: skip
    """Recall of the actions of the model's settled row, by seed; nothing if no behaviour lies beside it."""
    beside = behaviour_path(plan.model)
    own = [spec for spec in rows if spec.model == str(plan.model) and spec.settle]
    if not own or not beside.is_file():
        return {}
    seeds, count = list(plan.seeds_of(own[0])), min(plan.data.scenes, len(open_dataset(plan.data.tests)))
    lots = [tuple(range(start, min(start + LOT, count))) for start in range(0, count, LOT)]
    model = [sums[str(plan.model)], _sum_of(str(beside))]
    tasks = [
        array_task(
            behaviour_of_rooms, (own[0], plan.data, seed, lot), depends | {"model": model, "seed": seed, "lot": lot}
        )
        for seed in seeds
        for lot in lots
    ]
    results = run_all(tasks, folder, jobs, lambda done: progress("behaviour", done, len(tasks)))
    totals = np.array([part["counts"] for part in results]).reshape(len(seeds), len(lots), 3).sum(axis=1)
    return {(own[0], seed): right / wanted for seed, (wanted, right, _) in zip(seeds, totals, strict=True) if wanted}


def behaviour_of_rooms(spec: RowSpec, data: Data, seed: int, numbers: Sequence[int]) -> Arrays:
    """:func:`~..behaviour.behaviour_benchmark.count_right` of some test rooms."""
    rooms = [test_rooms(data)[number] for number in numbers]
    return {"counts": count_right(generator_of(spec.model), rooms, 1000 * seed + numbers[0])}


def _training_layouts(plan: TablePlan, depends: dict[str, Any], folder: Path, jobs: int, progress: Progress) -> Arrays:
    """Layouts of all training rooms, joined; none without a training set."""
    if not plan.data.training:
        return {"layout": np.zeros((0, 4)), "counts": np.zeros((0, 1))}
    count = len(open_dataset(plan.data.training))
    lots = [tuple(range(start, min(start + LAYOUT_LOT, count))) for start in range(0, count, LAYOUT_LOT)]
    tasks = [array_task(training_layouts, (plan.data, lot), depends | {"lot": list(lot)}) for lot in lots]
    return joined(run_all(tasks, folder, jobs, lambda done: progress("reading training rooms", done, len(tasks))))


def _varieties(
    plan: TablePlan, found: dict[Key, Arrays], training: Arrays, depends: dict[str, Any], sums: dict[str, str],
    folder: Path, jobs: int, progress: Progress,
) -> dict[Key, tuple[NDArray[np.float64], float]]:  # fmt: skip
    """Of each row and seed: distances to the nearest training rooms, and the mean distance between its rooms."""
    categories = len(vocabulary_of(plan.data))
    tasks = [
        array_task(
            variety_of, (_only_layouts(arrays), _only_layouts(training), categories),
            depends | {
                "row": _named(asdict(replace(spec, name="")), sums), "seed": seed, "scenes": len(arrays["counts"]),
                "training": len(training["counts"]),
            },
        )
        for (spec, seed), arrays in found.items()
    ]  # fmt: skip
    results = run_all(tasks, folder, jobs, lambda done: progress("comparing layouts", done, len(tasks)))
    return {key: (result["nearest"], float(result["pairwise"])) for key, result in zip(found, results, strict=True)}


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


def _named(record: dict[str, Any], sums: dict[str, str]) -> dict[str, Any]:
    """The record with checksums for paths."""
    return {name: sums.get(value, value) if isinstance(value, str) else value for name, value in record.items()}
