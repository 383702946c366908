"""Generators from few rooms that others made, judged on other rooms of theirs: ``unisg benchmark own-rooms``.

Takes houses of ProcTHOR (``--data FOLDER`` with ``oneroom.jsonl.gz`` and ``asset-database.json``). For each kind of
room and each seed some rooms are trained on, with all defaults; of the others five things each are asked for again by
the model and by simple rules, see :mod:`.place_scores`. Writes a line for each run, way and group, a summary with
intervals and paired tests, and the energy of each category.
"""

from __future__ import annotations

import argparse
import csv
import io
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import wilcoxon

from ...dataset import Sample, open_dataset, write_dataset
from ...dataset.scenes_with_shapes import scenes_with_shapes
from ...errors import UniSGError
from ...formats.layout_scenes import asset_folder, layout_scenes
from ...formats.layouts.procthor_houses import room_types
from ...generate import Generator
from ...geometry.arrays import Floats
from ...learn import job_list
from ...learn.hyperparameters import Settings
from ...runtime.atomic_files import write_file
from ...scene import SceneGraph
from ..reports import machine
from .baselines import CopyProposer, GaussianProposer
from .place_scores import GROUPS, SCORES, PlaceJudge, Removed, layouts_of, removals

HOUSES = "oneroom.jsonl.gz"
TRAINED, SEEDS, QUICK_ROOMS = 30, 3, 10
"""Rooms that are trained on, seeds, and rooms that are asked in a first look, which has one seed."""

MODEL, NETWORK, BOOTSTRAP, TRUTH = "unisg train", "network", "bootstrap", "true rooms"
RESAMPLED = 1000

Progress = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class OwnRoomsRun:
    """Rooms of a kind, split by a seed: what is trained on, and the things that are asked for in the others."""

    kind: str
    seed: int
    training: Sequence[SceneGraph]
    items: Sequence[Removed]

    @staticmethod
    def of(kind: str, rooms: Sequence[SceneGraph], count: int, seed: int, most: int) -> OwnRoomsRun:
        """Split at random: ``count`` to train on, at most ``most`` others."""
        order = np.random.default_rng((seed, 22)).permutation(len(rooms))
        training = [rooms[number] for number in order[:count]]
        known = sorted({name for graph in training for name in graph.vocabulary})
        items = [
            item for number in order[count : count + most] for item in removals(rooms[number], known, seed, int(number))
        ]
        return OwnRoomsRun(kind, seed, training, items)


def write_own_rooms(args: argparse.Namespace, folder: Path, progress: Progress) -> dict[str, Any]:
    """The whole benchmark; UniSGError without the houses."""
    if not args.data or not (args.data[0] / HOUSES).is_file():
        raise UniSGError(f"give the folder of ProcTHOR's houses: --data FOLDER with {HOUSES}")
    kinds: dict[str, list[SceneGraph]] = defaultdict(list)
    houses = args.data[0] / HOUSES
    for house in layout_scenes(houses, asset_folder(houses)):
        kinds[room_types(house.graph)].append(house.graph)
    folder.mkdir(parents=True, exist_ok=True)
    lines, seconds, found = [], {}, []
    for kind, rooms in sorted(kinds.items()):
        for seed in range(args.seed, args.seed + (1 if args.quick else SEEDS)):
            run = OwnRoomsRun.of(kind, rooms, TRAINED, seed, QUICK_ROOMS if args.quick else len(rooms))
            measured, seconds[f"{kind} {seed}"] = _measured(run, folder / "work" / f"{kind}-{seed}", progress)
            lines += list(_lines(run, measured))
            found.append((run, measured))
    _write(folder / "own_rooms_runs.csv", lines)
    _write(folder / "own_rooms.csv", list(_summary(found)))
    _write(folder / "own_rooms_categories.csv", list(_categories(found)))
    report = {"machine": machine(), "trained_on": TRAINED, "seconds": seconds, "rows": len(lines)}
    return report


def _measured(run: OwnRoomsRun, work: Path, progress: Progress) -> tuple[dict[str, Floats], float]:
    """Scores (N, :data:`SCORES`) by way, and seconds of the training."""
    model, start = work / "model.onnx", time.perf_counter()
    if not model.is_file():
        progress(f"{run.kind}, seed {run.seed}: training on {len(run.training)} rooms")
        write_dataset((Sample(graph, graph.title, run.kind) for graph in run.training), work / "rooms", overwrite=True)
        job_list.train("cgvae", [open_dataset(work / "rooms")], model, Settings(seed=run.seed, quiet=True))
    spent = round(time.perf_counter() - start, 1)
    generator = Generator.load(model)
    names, contract = generator.categories, generator.contract
    layouts = layouts_of(list(scenes_with_shapes(open_dataset(work / "rooms"))), names)
    plain = replace(generator.model, contract=replace(contract, plain=dict.fromkeys(names, 1.0)))
    sharp = replace(generator.model, contract=replace(contract, plain={}, sharpness={}))
    ways = {
        BOOTSTRAP: Generator(plain), MODEL: generator, "trees everywhere": Generator(sharp),
        "Gaussian on its support": Generator(generator.model, GaussianProposer(layouts)),
        "draw from training rooms": Generator(generator.model, CopyProposer(layouts, len(names), False)),
        "nearest training room": Generator(generator.model, CopyProposer(layouts, len(names), True)),
    }  # fmt: skip
    if (work / "network.onnx").is_file():
        ways[NETWORK] = Generator.load(work / "network.onnx")
    found = {}
    for name, way in ways.items():
        progress(f"{run.kind}, seed {run.seed}: {name}, {len(run.items)} things")
        found[name] = _scores(way, run, False)
    return found | {TRUTH: _scores(generator, run, True)}, spent


def _scores(way: Generator, run: OwnRoomsRun, truth: bool) -> Floats:
    rows = []
    for room, items in groupby(run.items, key=lambda item: item.room):
        there = list(items)
        judge, rng = PlaceJudge(way, there[0].rest), np.random.default_rng((run.seed, room))
        rows += [judge.truth(item) if truth else judge.scores(item, *judge.draws(item, rng)) for item in there]
    return np.array(rows)


def _lines(run: OwnRoomsRun, measured: dict[str, Floats]) -> Iterator[dict[str, Any]]:
    group = np.array([item.group for item in run.items])
    for way, scores in measured.items():
        for name in (*GROUPS, "all"):
            mine = (group == name) | (name == "all")
            share = _share(scores[mine], measured[BOOTSTRAP][mine])
            means = {score: _mean(scores[mine, number]) for number, score in enumerate(SCORES)}
            yield {"rooms": run.kind, "seed": run.seed, "way": way, "group": name, "things": int(mine.sum()),
                   "share": share, **means}  # fmt: skip


def _summary(found: Sequence[tuple[OwnRoomsRun, dict[str, Floats]]]) -> Iterator[dict[str, Any]]:
    """By kind of room ("every": all), way and group: all seeds, intervals by rooms drawn again, paired tests."""
    for kind in ("every", *sorted({run.kind for run, _ in found})):
        mine = [(run, measured) for run, measured in found if kind in ("every", run.kind)]
        group = np.array([item.group for run, _ in mine for item in run.items])
        room = np.array([f"{run.kind} {item.room}" for run, _ in mine for item in run.items])
        for way in [way for way in mine[0][1] if all(way in measured for _, measured in mine)]:
            scores, base, ours = (
                np.concatenate([measured[name] for _, measured in mine]) for name in (way, BOOTSTRAP, MODEL)
            )
            for name in (*GROUPS, "all"):
                rows = (group == name) | (name == "all")
                low, high = _interval(scores[rows, 0], base[rows, 0], room[rows])
                means = {score: _mean(scores[rows, number]) for number, score in enumerate(SCORES)}
                yield {"rooms": kind, "way": way, "group": name, "things": int(rows.sum()),
                       "share": _share(scores[rows], base[rows]), "low": low, "high": high,
                       "p_ours_nearer": _p_value(ours[rows, 0], scores[rows, 0]), **means}  # fmt: skip


def _categories(found: Sequence[tuple[OwnRoomsRun, dict[str, Floats]]]) -> Iterator[dict[str, Any]]:
    names = sorted({item.category for run, _ in found for item in run.items})
    category = np.array([item.category for run, _ in found for item in run.items])
    both = {way: np.concatenate([measured[way] for _, measured in found]) for way in (BOOTSTRAP, MODEL)}
    for name in names:
        mine = category == name
        energies = {way: _mean(scores[mine, 0]) for way, scores in both.items()}
        yield {"category": name, "things": int(mine.sum()), **energies}


def _share(scores: Floats, base: Floats) -> float | str:
    """Mean energy as a share of bootstrap's; "" for the truth, that has none."""
    return "" if not len(scores) or np.isnan(scores[:, 0]).all() else round(scores[:, 0].mean() / base[:, 0].mean(), 4)


def _mean(values: Floats) -> float | str:
    return "" if not np.isfinite(values).any() else round(float(np.nanmean(values)), 4)


def _interval(scores: Floats, base: Floats, room: Any) -> tuple[float | str, float | str]:
    """95 % interval of the share: rooms are drawn with replacement."""
    if np.isnan(scores).any() or not len(scores):
        return "", ""
    names, number = np.unique(room, return_inverse=True)
    sums = np.stack([np.bincount(number, weights=values, minlength=len(names)) for values in (scores, base)])
    drawn = sums[:, np.random.default_rng(0).integers(len(names), size=(RESAMPLED, len(names)))].sum(axis=2)
    low, high = np.quantile(drawn[0] / drawn[1], [0.025, 0.975])
    return round(float(low), 4), round(float(high), 4)


def _p_value(ours: Floats, theirs: Floats) -> float | str:
    """That our energies are no lower than theirs on the same things: Wilcoxon's signed-rank test, one-sided."""
    if np.isnan(theirs).any() or not len(ours) or (ours == theirs).all():
        return ""
    return float(f"{wilcoxon(ours, theirs, alternative='less').pvalue:.2g}")


def _write(path: Path, lines: Sequence[dict[str, Any]]) -> None:
    text = io.StringIO()
    writer = csv.DictWriter(text, list(lines[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(lines)
    write_file(path, text.getvalue())
