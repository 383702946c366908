"""``unisg evaluate``: how good are the scenes that a model makes, beside simple rules and real scenes."""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import DONE, UniSGError
from ..pretrained import find_generator
from ..runtime.atomic_files import made_folder
from ..runtime.made_files import own_folder
from .argument_types import PATH, PROCESSES, SEED, whole
from .common import add_mapping, jobs_of
from .given_scenes import check_mapping, dataset_of
from .outputs import check_results

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..experiments.rooms.generation_benchmark import Progress, TablePlan

HELP = "Measure the rooms that a model furnishes, or that were furnished elsewhere, beside real rooms and baselines."
QUICK_SCENES, QUICK_TREES = 12, 50


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.add_argument(
        "model", metavar="MODEL_OR_ROOMS", type=PATH,
        help="a generator, a shipped one by name, or a folder of rooms that any other furnished: docs/evaluating.md; "
        "with --judge a scene file or a folder of them",
    )  # fmt: skip
    parser.add_argument(
        "--data", metavar="DATASET", type=PATH, help="rooms that it was not trained on; needed without --judge"
    )
    parser.add_argument(
        "--judge", metavar="WHICH", default="",
        help="do not compare, but let others judge scenes (files, folders): all, or some of stability "
        "(simulated in MuJoCo), navigability, openings (SceneEval's): docs/evaluating.md",
    )  # fmt: skip
    add_mapping(parser)
    parser.add_argument(
        "--training", metavar="DATASET", type=PATH,
        help="rooms that it was trained on: for the Gaussian and copy baselines, and for novelty",
    )  # fmt: skip
    parser.add_argument(
        "--also",
        metavar="MODEL",
        type=PATH,
        action="append",
        default=[],
        help="another model or folder beside it; repeatable",
    )
    parser.add_argument(
        "--scenes", metavar="N", type=whole(1, 10**6), default=300, help="how many rooms at most (default: 300)"
    )
    parser.add_argument("--seeds", metavar="N", type=whole(1, 1000), default=3, help="rounds of drawing (default: 3)")
    parser.add_argument("--seed", type=SEED, default=0, help="the first of them; same seed, same result (default: 0)")
    parser.add_argument("--quick", action="store_true", help="12 rooms, one seed and 50 trees, unless told otherwise")
    parser.add_argument("--jobs", metavar="N", type=PROCESSES, help="processes (one per processor)")
    parser.add_argument(
        "--out", metavar="DIR", type=PATH,
        help="write table.md, .csv, .json and .png there, and keep results: a second run goes on where one stopped",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    """Measure and print the table."""
    if args.judge:
        from .judged_scenes import run_judges

        return run_judges(args)
    if args.data is None:
        raise UniSGError("give --data, rooms to compare with, or --judge to have scenes judged by themselves")
    from ..experiments.reports import made_by
    from ..experiments.rooms.generation_benchmark import compare
    from ..experiments.rooms.generation_report import table, write_report

    check_results("--out", args.out, [args.data, args.training, args.model, *args.also])
    if rooms := [path for path in (args.model, *args.also) if path.is_dir()]:
        check_mapping(args, rooms)
    jobs, start = jobs_of(args), time.perf_counter()
    with _folder(args.out) as folder, _bars(args.quiet) as progress:
        plan = _plan(args, folder, jobs)
        rows = compare(plan, folder, jobs, progress)
    facts: dict[str, Any] = made_by() | {
        "model": args.model.name, "data": str(args.data), "training": str(args.training or ""),
        "also": [path.name for path in args.also], "scenes": plan.data.scenes, "seeds": plan.seeds,
        "first_seed": plan.first_seed, "trees": plan.trees,
        "seconds": round(time.perf_counter() - start, 1),
    }  # fmt: skip
    report = facts | {"rows": [row.to_record() for row in rows]}
    if args.out is not None:
        report = write_report(rows, facts, args.out)
    print(json.dumps(report, ensure_ascii=False) if args.json else table(rows))
    return DONE


def _plan(args: argparse.Namespace, work: Path, jobs: int) -> TablePlan:
    from ..dataset.format.reader import open_dataset
    from ..experiments.rooms.atiss_proposer import load_generator
    from ..experiments.rooms.benchmark_rows import Data
    from ..experiments.rooms.generation_benchmark import TablePlan
    from ..metrics.two_sample_test import FOLDS, TREES
    from ..scene.categories import STRUCTURE

    tests = open_dataset(args.data)
    training = "" if args.training is None else str(open_dataset(args.training).path)
    scenes, models, known = min(args.scenes, len(tests)), [], set(tests.category_counts)
    for path in (args.model, *args.also):
        if path.is_dir():
            path = dataset_of(args, path, work, jobs)
            scenes = min(scenes, len(open_dataset(path)))  # as many real rooms as there are given ones
        else:
            path = find_generator(path)
        models.append(path)
        known &= set(open_dataset(path).category_counts if path.is_dir() else load_generator(path).categories)
    if not known - set(STRUCTURE):
        raise UniSGError(f"{args.data} has no category of things that {args.model} knows: give a --mapping of names")
    if scenes < FOLDS:
        raise UniSGError(f"{scenes} rooms are too few to be measured: give {FOLDS} at least, given ones and real ones")
    scenes = min(scenes, QUICK_SCENES) if args.quick else scenes
    data = Data(str(tests.path), training, scenes)
    seeds, trees = (1, QUICK_TREES) if args.quick else (args.seeds, TREES)
    return TablePlan(models[0], data, tuple(models[1:]), seeds, args.seed, trees)


@contextmanager
def _folder(out: Path | None) -> Iterator[Path]:
    """Where results are kept: under the output folder, or nowhere for long."""
    if out is None:
        with tempfile.TemporaryDirectory(prefix="unisg-evaluate-") as name:
            yield Path(name)
        return
    with own_folder("--out", out), made_folder(out / "measured"):
        yield out / "measured"


@contextmanager
def _bars(quiet: bool) -> Iterator[Progress]:
    """A progress bar per step."""
    from ..runtime.progress import Progress as Bar

    bars: dict[str, Bar] = {}

    def progress(step: str, done: int, total: int) -> None:
        """Show how far a step is, each on a bar of its own."""
        if step not in bars:
            for bar in bars.values():
                bar.close()
            bars.clear()
            bars[step] = Bar(total, step, quiet)
        bars[step].update(done)

    try:
        yield progress
    finally:
        for bar in bars.values():
            bar.close()
