"""Options of a batch: how many rooms, what is written, by how many processes or which cluster."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..batches.batch_plan import FORMATS, BatchOptions, Task
from ..batches.batch_run import batch_steps
from ..runtime.job_pool import dask_executor
from ..runtime.progress import Progress
from ..runtime.steps import drain
from .argument_types import PATH, PROCESSES, number, whole
from .common import add_form

VARIED = {
    "reroll": "take out and place anew",
    "lock": "leave as they are",
    "remove": "take out",
    "swap": "give another shape of their category",
}
"""What of a file of variations is an option, too."""


def add_batch_options(parser: argparse.ArgumentParser) -> None:
    """What makes a single room many."""
    group = parser.add_argument_group("batches", "many rooms into a folder, each with its number for a seed")
    group.add_argument("--count", metavar="N", type=whole(1, 10**7), help="variations of each scene, or rooms (1)")
    group.add_argument("--format", choices=FORMATS, help="what to write (blend)")
    group.add_argument(
        "--vary", metavar="FILE", type=PATH, help="TOML file that says what varies (docs/examples/variations.toml)"
    )
    for name, what in VARIED.items():
        group.add_argument(f"--{name}", metavar="NAMES", help=f'things to {what}, such as "Chair,Book"')
    add_form(group)
    add_running_options(group)


def add_running_options(group: argparse._ActionsContainer) -> None:
    """How a batch is run."""
    group.add_argument("--jobs", metavar="N", type=PROCESSES, help="rooms made at a time (one per processor)")
    group.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask scheduler whose workers see the same folders")
    group.add_argument(
        "--timeout", metavar="SECONDS", type=number(0.1, 10**7), default=300.0, help="limit for one room (300)"
    )
    group.add_argument(
        "--memory", metavar="GIB", type=number(0.1, 10**6), default=4.0,
        help="a process that has used so much is replaced (4)",
    )  # fmt: skip
    again = group.add_mutually_exclusive_group()
    again.add_argument("--resume", action="store_true", help="go on with an interrupted batch")
    again.add_argument("--overwrite", action="store_true", help="replace what an earlier batch made in that folder")


def variation_words(args: argparse.Namespace) -> dict[str, str | None]:
    """What the options say that a file of variations may say, too."""
    return {name: getattr(args, name) for name in VARIED}


def batch_reason(args: argparse.Namespace) -> str:
    """What asks for many rooms: an option that only batches have, or several scenes; "" where one room is asked for."""
    for name in ("count", "format", "jobs", "scheduler", "vary", *VARIED):
        if getattr(args, name) is not None:
            return f"--{name}"
    scenes = args.scene or ()
    many = len(scenes) > 1 or any(Path(scene).is_dir() or any(sign in scene for sign in "*?[") for scene in scenes)
    return "--resume" if args.resume else "--overwrite" if args.overwrite else "a --scene of several" * many


def batch_options(args: argparse.Namespace, maker: str, settings: dict[str, Any]) -> BatchOptions:
    """The options of a batch out of those of the command line."""
    return BatchOptions(
        maker, settings, args.format or "blend", args.form, timeout=args.timeout, memory=int(args.memory * 2**30)
    )


def made_rooms(args: argparse.Namespace, tasks: Sequence[Task], options: BatchOptions) -> list[dict[str, Any]]:
    """Make the rooms of a batch with progress and a line for each that fails; returns their records."""
    bar, counts = Progress(len(tasks), "rooms", args.quiet), Counter[str]()

    def show(step: tuple[list[dict[str, Any]], int]) -> None:
        """Show which rooms are done."""
        for record in step[0]:
            counts[record["status"]] += 1
            if record["status"] == "failed":
                bar.write(f"{record['source']}: {record['reason']}")
        bar.update(counts.total(), counts["failed"])

    with dask_executor(args.scheduler) as executor:
        steps = batch_steps(
            tasks, args.out, options, executor=executor, jobs=args.jobs, resume=args.resume, overwrite=args.overwrite
        )
        try:
            return drain(steps, show)
        finally:
            bar.close()
