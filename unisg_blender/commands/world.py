"""``unisg world``: make procedural scenes and write them as files or as a dataset."""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

from ..batches.batch_plan import FORMATS, plan_rooms
from ..batches.room_makers import WORLD
from ..errors import DONE, SOME_FAILED, UniSGError
from ..worlds import WORLDS
from ..worlds.world_batches import BATCH, can_be_imported
from .argument_types import PATH, SEED, whole
from .batch_options import add_running_options, batch_options, made_rooms
from .common import add_dataset_options, add_form, jobs_of, mesh_encoder_of, print_report, vocabulary_of
from .outputs import check_folder

HELP = "Make procedural scenes."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.add_argument("name", metavar="NAME", choices=WORLDS, help="which world: " + ", ".join(WORLDS))
    parser.add_argument("--count", metavar="N", type=whole(1, 10**6), default=1, help="how many scenes (1)")
    parser.add_argument("--out", metavar="DIR", type=PATH, required=True, help="folder of the files, or of the dataset")
    parser.add_argument("--seed", metavar="S", type=SEED, default=0, help="the scenes have the seeds S, S+1, ... (0)")
    parser.add_argument("--format", choices=FORMATS, default="blend", help="what to write (blend)")
    add_form(parser)
    add_dataset_options(parser)
    add_running_options(parser)


def run(args: argparse.Namespace) -> int:
    """Make the scenes and write them."""
    from ..runtime.serving_process import load_function

    if args.format != "dataset" and (args.mesh_features or args.vocabulary):
        raise UniSGError("--mesh-features and --vocabulary are of datasets: give --format dataset as well")
    check_folder("--out", args.out)
    if args.mesh_features:
        load_function(mesh_encoder_of(args))
    world = WORLDS[args.name]
    elsewhere = can_be_imported(world)
    if args.scheduler and not elsewhere:
        raise UniSGError(
            "a world of your own must be in a module that other processes can import: leave --scheduler out"
        )
    few = args.scheduler is None and min(jobs_of(args), args.count // BATCH) < 2
    settings = {"world": args.name, "function": f"{world.__module__}:{world.__name__}" if elsewhere else ""}
    options = replace(
        batch_options(args, WORLD, settings), mesh_encoder=mesh_encoder_of(args), vocabulary=vocabulary_of(args),
        here=few or not elsewhere,
    )  # fmt: skip
    started = time.perf_counter()
    records = made_rooms(args, plan_rooms([], args.count, args.seed, args.name), options)
    seconds = time.perf_counter() - started
    files = [str(args.out / record["file"]) for record in records if "file" in record]
    report = {"world": args.name, "seed": args.seed, "scenes": args.count, "seconds": round(seconds, 3)}
    report |= {"format": args.format, "out": str(args.out), "files": files}
    print_report(args, report, [f"{args.out}: {args.count} scenes of {args.name} in {seconds:.1f} s"])
    return SOME_FAILED if any(record["status"] == "failed" for record in records) else DONE
