"""Writes the poses benchmark: one CSV per table, one JSON with everything, the figure."""

from __future__ import annotations

import argparse
import csv
import json
import os
import platform
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

from .poses_benchmark import Table, measure_poses
from .poses_figure import draw_poses

PACKAGES = ("numpy", "scipy", "clifford", "torch")


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
        ``machine``, ``settings`` and ``tables``: what the JSON file holds.
    """
    tables = measure_poses(args.count, args.repeats, args.seed, progress)
    report = {
        "machine": machine(),
        "settings": {"count": args.count, "repeats": args.repeats, "seed": args.seed},
        "tables": tables,
    }
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder, prefix=".unfinished") as name:
        draft = Path(name)
        (draft / "poses.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
        for table, rows in tables.items():
            if rows:
                write_csv(draft / f"poses_{table}.csv", rows)
        draw_poses(tables, [draft / "poses.png", draft / "poses.svg"])
        for file in draft.iterdir():
            os.replace(file, folder / file.name)
    return report


def write_csv(path: Path, rows: Table) -> None:
    """Write rows under the union of their keys, in the order in which these first appear."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)


def machine() -> dict[str, Any]:
    """What the numbers were measured on."""
    return {
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        "processors": os.cpu_count(),
        **{package: _version(package) for package in PACKAGES},
    }


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None
