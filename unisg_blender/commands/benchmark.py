"""``unisg benchmark``: measure, and write tables (CSV, JSON) and figures (PNG, SVG)."""

from __future__ import annotations

import argparse
import importlib
import math
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..errors import DONE, UniSGError
from .common import check_at_least, jobs_of, print_report

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
    "paper": (
        "the paper's experiments, and a fair comparison of forms",
        "..experiments.paper.paper_report:write_paper_report",
    ),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    names = "; ".join(f"{name}: {text}" for name, (text, _) in BENCHMARKS.items())
    parser.add_argument("name", choices=BENCHMARKS, help=names)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for tables and figures")
    parser.add_argument("--count", type=int, default=1_000_000, help="poses to time (default: 1000000)")
    parser.add_argument("--repeats", type=int, default=5, help="rounds whose median counts (default: 5)")
    parser.add_argument("--data", type=Path, nargs="+", metavar="DIR", help="folders of mesh files (meshes)")
    parser.add_argument("--seed", type=int, default=0, help="of everything random (default: 0)")
    parser.add_argument("--quick", action="store_true", help="a first look in minutes (paper)")
    parser.add_argument(
        "--jobs", metavar="N", type=int, help="trainings or rooms at a time, default: one per processor (paper, rooms)"
    )
    parser.add_argument(
        "--rates", type=float, nargs="+", metavar="R", help="learning rates that every form is tried with (paper)"
    )
    parser.add_argument("--tables-only", action="store_true", help="tables of what has been trained so far (paper)")


def run(args: argparse.Namespace) -> int:
    """Run one benchmark."""
    check_at_least(args, 1, "count", "repeats", "jobs")
    if args.rates and not all(0 < rate < math.inf for rate in args.rates):
        raise UniSGError("--rates must be numbers above 0")
    jobs_of(args)  # before a library that computes is loaded
    _check_folder(args.out)
    module, function = BENCHMARKS[args.name][1].split(":")
    measure: Callable[..., dict[str, Any]] = getattr(importlib.import_module(module, __package__), function)

    def progress(step: str) -> None:
        """Say on standard error which step begins."""
        if not args.quiet:
            print(f"{args.name}: {step}", file=sys.stderr, flush=True)

    report = measure(args, args.out, progress)
    print_report(args, report, [f"wrote {args.out}: {', '.join(sorted(p.name for p in args.out.iterdir()))}"])
    return DONE


def _check_folder(out: Path) -> None:
    """UniSGError if the folder can be neither made nor written to."""
    above = next(path for path in (out.absolute(), *out.absolute().parents) if path.exists())
    if not above.is_dir() or not os.access(above, os.W_OK):
        raise UniSGError(f"cannot write to {out}: {above} is no folder that can be written to")
