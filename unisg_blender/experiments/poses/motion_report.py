"""Writes the comparison of keyframe reductions: one CSV, one JSON. Needs Blender."""

from __future__ import annotations

import argparse
import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ...errors import MissingPackageError
from .poses_report import machine, write_csv

MILLIMETRES, DEGREES = 1.0, 0.1


def write_motion_report(args: argparse.Namespace, folder: Path, progress: Callable[[str], None]) -> dict[str, Any]:
    """Reduce the same motions in every way at the same tolerance, then write all files.

    Parameters
    ----------
    args
        With ``seed``.
    folder
        Where the files go; made if it is not there.
    progress
        Called with the name of each step.

    Returns
    -------
    dict
        ``machine``, ``settings`` and ``reductions``: what the JSON file holds.

    Raises
    ------
    MissingPackageError
        Without Blender.
    """
    try:
        from ...blender.motion.reduction_comparison import BLENDER, compare_reductions
    except ImportError:
        raise MissingPackageError("Blender's Python module bpy", "blender") from None

    progress("reductions")
    rows = compare_reductions(MILLIMETRES, DEGREES, args.seed)
    settings = {"millimetres": MILLIMETRES, "degrees": DEGREES, "seed": args.seed}
    report = {
        "machine": {**machine(), "blender": BLENDER},
        "settings": settings,
        "reductions": rows,
    }
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder, prefix=".unfinished") as name:
        draft = Path(name)
        (draft / "motion.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
        write_csv(draft / "motion.csv", rows)
        for file in draft.iterdir():
            os.replace(file, folder / file.name)
    return report
