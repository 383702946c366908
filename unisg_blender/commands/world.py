"""``unisg world``: make procedural scenes and write them as files or as a dataset."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import DONE, UniSGError
from ..formats.scene_files import write_scene_file
from ..runtime.made_files import check_made, mark_made
from ..worlds.world_batches import make_many
from .argument_types import PROCESSES, SEED, whole
from .common import add_dataset_options, add_form, jobs_of, make_folder, mesh_encoder_of, print_report, vocabulary_of
from .outputs import check_folder

if TYPE_CHECKING:
    from ..runtime.progress import Progress
    from ..scene.graph import SceneGraph

HELP = "Make procedural scenes."
FORMATS = ("blend", "usda", "dataset", "json")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    from ..worlds import WORLDS

    parser.add_argument("name", metavar="NAME", choices=WORLDS, help="which world: " + ", ".join(WORLDS))
    parser.add_argument("--count", metavar="N", type=whole(1, 10**6), default=1, help="how many scenes (1)")
    parser.add_argument("--out", metavar="DIR", type=Path, required=True, help="folder of the files, or of the dataset")
    parser.add_argument("--seed", metavar="S", type=SEED, default=0, help="the scenes have the seeds S, S+1, ... (0)")
    parser.add_argument("--format", choices=FORMATS, default="blend", help="what to write (blend)")
    add_form(parser)
    add_dataset_options(parser)
    parser.add_argument("--jobs", metavar="N", type=PROCESSES, help="scenes made at a time (one per processor)")
    parser.add_argument("--overwrite", action="store_true", help="replace files or a dataset in that folder")


def run(args: argparse.Namespace) -> int:
    """Make the scenes and write them."""
    from ..runtime.progress import Progress

    if args.format != "dataset" and (args.mesh_features or args.vocabulary):
        raise UniSGError("--mesh-features and --vocabulary are of datasets: give --format dataset as well")
    check_folder("--out", args.out)
    started = time.perf_counter()
    bar = Progress(args.count, "scenes", args.quiet)
    try:
        files = _write_dataset(args, bar) if args.format == "dataset" else _write_files(args, bar)
    finally:
        bar.close()
    seconds = time.perf_counter() - started
    report = {"world": args.name, "seed": args.seed, "scenes": args.count, "seconds": round(seconds, 3)}
    report |= {"format": args.format, "out": str(args.out), "files": files}
    print_report(args, report, [f"{args.out}: {args.count} scenes of {args.name} in {seconds:.1f} s"])
    return DONE


def _scenes(args: argparse.Namespace, bar: Progress) -> Iterator[SceneGraph]:
    seeds = range(args.seed, args.seed + args.count)
    for done, graph in enumerate(make_many(args.name, seeds, jobs_of(args)), start=1):
        yield graph
        bar.update(done)


def _write_dataset(args: argparse.Namespace, bar: Progress) -> list[str]:
    from ..dataset import Sample, write_dataset
    from ..runtime.serving_process import load_function

    encoder = load_function(mesh_encoder_of(args)) if args.mesh_features else None
    vocabulary = vocabulary_of(args)
    scenes = (Sample(graph, graph.title, args.name) for graph in _scenes(args, bar))
    write_dataset(scenes, args.out, args.form, mesh_encoder=encoder, vocabulary=vocabulary, overwrite=args.overwrite)
    return []


def _write_files(args: argparse.Namespace, bar: Progress) -> list[str]:
    """One file per scene, named after world and seed; nothing is begun if one of them is there already."""
    paths = [args.out / f"{args.name}-{args.seed + number:05d}.{args.format}" for number in range(args.count)]
    taken = next((path for path in paths if path.exists()), None)
    if taken is not None and not args.overwrite:
        raise UniSGError(f"{taken} exists already: choose another folder, or use --overwrite")
    check_made(args.out, [path.name for path in paths])
    make_folder(args.out)
    mark_made(args.out, [path.name for path in paths])
    for path, graph in zip(paths, _scenes(args, bar), strict=True):
        write_scene_file(graph, path)
    return [str(path) for path in paths]
