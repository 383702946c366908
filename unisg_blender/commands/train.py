"""``unisg train``: a model from a dataset."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import DONE, UniSGError
from ..learn import job_list
from ..learn.hyperparameters import ACCELERATORS, Settings
from ..learn.job_list import JOBS
from ..runtime.process_end import end_with_parent
from . import given_scenes, train_meshes
from .argument_types import PATH, PROCESSES, SEED, whole
from .common import add_mapping, print_report
from .outputs import check_file, check_folder

if TYPE_CHECKING:
    from ..dataset.format.reader import Dataset

HELP = "Train a model on a dataset and write it as an ONNX file that runs without torch."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    from ..poses import FORMS

    texts = "; ".join(f"{name}: {job.text}" for name, job in JOBS.items())
    parser.add_argument("job", choices=JOBS, help=texts)
    parser.add_argument(
        "--data", metavar="DATASET_OR_SCENES", type=PATH, nargs="+", required=True,
        help="folder of a dataset, or of scene files, which become one for this training",
    )  # fmt: skip
    add_mapping(parser)
    parser.add_argument("--out", metavar="MODEL.onnx", type=PATH, required=True, help="file (meshes: folder) to write")
    parser.add_argument("--form", choices=FORMS, help="form of the poses that the network sees")
    parser.add_argument("--epochs", metavar="N", type=whole(1, 10**6), help="passes over the dataset")
    parser.add_argument("--seed", type=SEED, default=0, help="same seed, same model (default: 0)")
    parser.add_argument("--paper", action="store_true", help="the paper's architecture and losses")
    parser.add_argument(
        "--accelerator", choices=ACCELERATORS, default="auto", help="what computes: a GPU if there is one (auto)"
    )
    parser.add_argument(
        "--devices",
        metavar="N",
        type=PROCESSES,
        default=1,
        help="GPUs, else processes, on this machine (default: 1)",
    )
    parser.add_argument("--nodes", metavar="N", type=whole(1, 10**4), default=1, help="machines (default: 1)")
    parser.add_argument(
        "--patience", metavar="N", type=whole(1, 10**6), help="stop after N epochs without a better loss"
    )
    parser.add_argument("--logs", metavar="DIR", type=PATH, help="keep checkpoints and metrics.csv there, and resume")
    train_meshes.add_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Train, export, report."""
    if int(os.environ.get("LOCAL_RANK", 0)):  # another process that trains has started this one
        end_with_parent()
    if args.job == "meshes":
        return train_meshes.run(args)
    _check(args)
    with tempfile.TemporaryDirectory(prefix="unisg-train-") as work:
        return _train(args, Path(work))


def _train(args: argparse.Namespace, work: Path) -> int:
    from ..dataset.format.reader import open_dataset

    paths = [given_scenes.dataset_of(args, path, work) for path in args.data]
    with given_scenes.named_as_given(args.data, paths):
        return _trained(args, list(map(open_dataset, paths)))


def _trained(args: argparse.Namespace, datasets: list[Dataset]) -> int:
    told = [] if JOBS[args.job].several else job_list.load("provenance").dataset_notes(datasets[0])
    if not args.quiet:
        for note in told:  # now, while stopping costs nothing
            print(f"note: {note}", file=sys.stderr)
    start = time.perf_counter()
    settings = Settings(
        form=args.form, epochs=args.epochs, seed=args.seed, paper=args.paper, accelerator=args.accelerator,
        devices=args.devices, nodes=args.nodes, logs=args.logs, patience=args.patience, quiet=args.quiet,
        command=_command(args),
    )  # fmt: skip
    report = {"model": str(args.out), **job_list.train(args.job, datasets, args.out, settings)}
    report["seconds"] = round(time.perf_counter() - start, 1)
    print_report(args, report, _lines(report, told))
    return DONE


def _command(args: argparse.Namespace) -> str:
    """The command that makes this model again, wherever the dataset lies."""
    words = ["unisg", "train", args.job, "--data", *(path.name for path in args.data), "--out", args.out.name]
    for name in ("mapping", "assets", "form", "epochs", "seed", "patience"):
        value = getattr(args, name)
        if value is not None:
            words += [f"--{name}", value.name if isinstance(value, Path) else str(value)]
    return shlex.join([*words, *(["--paper"] if args.paper else [])])


def _check(args: argparse.Namespace) -> None:
    if len(args.data) > 1 and not JOBS[args.job].several:
        raise UniSGError(f"'train {args.job}' takes one dataset, not {len(args.data)}")
    given_scenes.check_mapping(args, args.data)
    if max(args.devices, args.nodes) > 1 and not all(map(given_scenes.is_dataset, args.data)):
        raise UniSGError("several devices learn from datasets: make one of the scene files first, with 'unisg export'")
    check_file("--out", args.out, (".onnx",))
    check_folder("--logs", args.logs, args.data)


def _lines(report: dict[str, Any], told: list[str]) -> list[str]:
    losses = ", ".join(f"{name} {value:.4f}" for name, value in report["losses"].items())
    if "held_out" in report:
        lines = [
            f"{report['model']}: {report['parameters']} trees of {report['scenes_trained']} rooms, "
            f"measured on each room while it was held out, {report['seconds']} s"
        ]
        lines += report["report"]
        return lines + [f"note: {note}" for note in report["notes"] if note not in told]
    lines = [
        f"{report['model']}: {report['parameters']} parameters, {report['seconds']} s",
        f"trained on {report['scenes_trained']} scenes, {report['scenes_held_out']} held out: {losses}",
    ]
    return lines + [f"note: {note}" for note in report.get("notes", ()) if note not in told]
