"""``unisg benchmark``: measure, and write tables (CSV, JSON) and figures (PNG, SVG)."""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Callable
from typing import Any

from ..errors import DONE
from ..runtime.made_files import MARKER, own_folder
from .argument_types import PATH, PROCESSES, SEED, number, whole
from .common import jobs_of, print_report
from .outputs import check_folder

HELP = "Measure in one run and write tables (CSV, JSON) and figures (PNG, SVG)."

# name -> what it measures, and "module:function": (args, folder, progress) -> report; the function writes its files
BENCHMARKS = {
    "poses": ("exactness and speed of the representation forms", "..experiments.poses.poses_report:write_poses_report"),
    "motion": ("keyframe reduction beside Blender's own", "..experiments.poses.motion_report:write_motion_report"),
    "meshes": (
        "mesh features, decoded meshes and proposed categories",
        "..experiments.meshes.meshes_report:write_meshes_report",
    ),
    "rooms": ("the frozen rooms to train and measure generators on", "..experiments.rooms.frozen_rooms:write_rooms"),
    "own-rooms": (
        "generators from few rooms of others (ProcTHOR), beside simple rules",
        "..experiments.rooms.own_rooms:write_own_rooms",
    ),
    "paper": (
        "the paper's experiments, and a fair comparison of forms",
        "..experiments.paper.paper_report:write_paper_report",
    ),
    "algebra": (
        "what symmetry and geometric algebra do for networks over rooms, from 10 rooms on",
        "..experiments.algebra.algebra_report:write_algebra_report",
    ),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    names = "; ".join(f"{name}: {text}" for name, (text, _) in BENCHMARKS.items())
    parser.add_argument("name", choices=BENCHMARKS, help=names)
    parser.add_argument("--out", type=PATH, required=True, metavar="DIR", help="folder for tables and figures")
    parser.add_argument("--count", type=whole(1, 10**7), default=1_000_000, help="poses to time (default: 1000000)")
    parser.add_argument("--repeats", type=whole(1, 1000), default=5, help="rounds whose median counts (default: 5)")
    parser.add_argument(
        "--data",
        type=PATH,
        nargs="+",
        metavar="DIR",
        help="folders of mesh files (meshes), or of houses (own-rooms, algebra)",
    )
    parser.add_argument("--seed", type=SEED, default=0, help="of everything random (default: 0)")
    parser.add_argument("--quick", action="store_true", help="a first look in minutes (paper, own-rooms, algebra)")
    parser.add_argument(
        "--jobs",
        metavar="N",
        type=PROCESSES,
        help="trainings or rooms at a time, default: one per processor (paper, rooms, algebra)",
    )
    parser.add_argument(
        "--rates",
        type=number(1e-9, 1e3),
        nargs="+",
        metavar="R",
        help="learning rates that every form is tried with (paper)",
    )
    parser.add_argument(
        "--tables-only", action="store_true", help="tables of what has been trained so far (paper, algebra)"
    )


def run(args: argparse.Namespace) -> int:
    """Run one benchmark."""
    jobs_of(args)  # before a library that computes is loaded
    check_folder("--out", args.out, args.data or ())
    module, function = BENCHMARKS[args.name][1].split(":")
    measure: Callable[..., dict[str, Any]] = getattr(importlib.import_module(module, __package__), function)

    def progress(step: str) -> None:
        """Say on standard error which step begins."""
        if not args.quiet:
            print(f"{args.name}: {step}", file=sys.stderr, flush=True)

    with own_folder("--out", args.out):
        report = measure(args, args.out, progress)
    written = sorted(path.name for path in args.out.iterdir() if path.name != MARKER)
    print_report(args, report, [f"wrote {args.out}: {', '.join(written)}"])
    return DONE
