"""Writes the poses benchmark: one CSV per table, one JSON with everything, the figure."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ...runtime.made_files import filling
from ..reports import made_by, write_csv, write_json
from .poses_benchmark import measure_poses
from .poses_figure import draw_poses


def write_poses_report(args: argparse.Namespace, folder: Path, progress: Callable[[str], None]) -> dict[str, Any]:
    """Measure, then write all files; nothing is written if a measurement fails.

    Parameters
    ----------
    args
        With ``count``, ``repeats`` and ``seed``.
    folder
        Where the files go; made if it is not there.
    progress
        Called with the name of each step.

    Returns
    -------
    dict
        ``command``, ``date``, ``machine``, ``settings`` and ``tables``: what the JSON file holds.
    """
    tables = measure_poses(args.count, args.repeats, args.seed, progress)
    report = {
        **made_by(),
        "settings": {"count": args.count, "repeats": args.repeats, "seed": args.seed},
        "tables": tables,
    }
    with filling(folder) as draft:
        write_json(draft / "poses.json", report)
        for table, rows in tables.items():
            if rows:
                write_csv(draft / f"poses_{table}.csv", rows)
        draw_poses(tables, [draft / "poses.png", draft / "poses.svg"])
    return report
