"""``unisg train meshes``: AtlasNet and the model of categories, from folders of mesh files."""

from __future__ import annotations

import argparse
import shlex
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from .. import __version__
from ..errors import DONE, UniSGError
from ..learn.atlasnet.world_shapes import world_models
from ..learn.job_list import load
from ..meshes.shape_files import SPLITS, ShapeFile, of_split, read_models
from .argument_types import PROCESSES, whole
from .common import print_report
from .outputs import check_folder

WORLDS_WITH_OBJECTS = ("operating-room", "living-room")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What "meshes" takes beyond the arguments of all jobs."""
    own = parser.add_argument_group("meshes")
    own.add_argument(
        "--steps", metavar="N", type=whole(0, 10**9), help="training steps; 0 keeps the networks and refits categories"
    )
    own.add_argument(
        "--rooms", metavar="N", type=whole(0, 10**4), default=12, help="rooms of each world whose meshes are used (12)"
    )
    own.add_argument(
        "--threads", metavar="N", type=PROCESSES, default=1, help="cores; with 1 the result repeats exactly (1)"
    )


def run(args: argparse.Namespace) -> int:
    """Train, export, report."""
    check_folder("--out", args.out, args.data)
    if args.mapping or args.assets:
        raise UniSGError("'train meshes' reads mesh files, of which --mapping and --assets say nothing: leave them out")
    start = time.perf_counter()
    models = read_models(args.data)
    unseen = {model.category for model in of_split(models, "unseen")}
    rooms = world_models(WORLDS_WITH_OBJECTS, args.rooms, args.seed)
    models += [model for model in rooms if model.category not in unseen]
    args.out.mkdir(parents=True, exist_ok=True)
    provenance = _provenance(args, models)
    report: dict[str, Any] = {"out": str(args.out), "meshes": len(models)}
    if args.steps != 0:
        report |= _train_networks(args, of_split(models, "train"), provenance)
    report |= _fit_labels(args, models, provenance)
    report["seconds"] = round(time.perf_counter() - start, 1)
    print_report(args, report, (f"{key}: {value}" for key, value in report.items()))
    return DONE


def _train_networks(args: argparse.Namespace, models: list[ShapeFile], provenance: dict[str, Any]) -> dict[str, Any]:
    training, export = load("atlasnet.training"), load("atlasnet.export").export
    settings = training.MeshTraining(seed=args.seed, threads=args.threads, accelerator=args.accelerator)
    settings = settings if args.steps is None else replace(settings, steps=args.steps)

    def show(step: int, loss: float) -> None:
        """Show step and loss on one line."""
        if not args.quiet:
            print(f"\rstep {step + 1}/{settings.steps}  chamfer {loss:.5f} ", end="", file=sys.stderr, flush=True)

    network, report = training.train(models, settings, show)
    if not args.quiet:
        print(file=sys.stderr)
    paths = export(network, args.out, provenance | {"training": report})
    return {"networks": [str(path) for path in paths], "training": report}


def _fit_labels(args: argparse.Namespace, models: list[ShapeFile], provenance: dict[str, Any]) -> dict[str, Any]:
    from ..learn.object_categories.training import fit_labels
    from ..meshes.atlasnet_sessions import ENCODER_FILE
    from ..meshes.shape_feature import AtlasNetEncoder
    from ..predict.category_model import LABELS_FILE
    from ..worlds import WORLDS

    own: Path = args.out / ENCODER_FILE
    scenes = [WORLDS[name](args.seed + room) for name in WORLDS_WITH_OBJECTS for room in range(args.rooms)]
    known, judges = of_split(models, "train") + of_split(models, "known"), of_split(models, "trust")
    encoder = AtlasNetEncoder(own if own.is_file() else None)
    labels = fit_labels(known, scenes, encoder, provenance, judges=judges)
    labels.save(args.out / LABELS_FILE)
    return {"labels": str(args.out / LABELS_FILE), "categories": len(labels.vocabulary)}


def _provenance(args: argparse.Namespace, models: list[ShapeFile]) -> dict[str, Any]:
    counts = {split: len(of_split(models, split)) for split in SPLITS}
    words = [Path(word).name if word.startswith("/") else word for word in sys.argv[1:]]
    return {
        "command": shlex.join(["unisg", *words]), "version": __version__, "seed": args.seed, "models": counts,
        "credits": "docs/meshes.md",
    }  # fmt: skip
