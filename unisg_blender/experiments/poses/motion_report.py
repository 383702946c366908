"""Writes the comparison of keyframe reductions: one CSV, one JSON. Needs Blender."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ...errors import MissingPackageError
from ...runtime.made_files import filling
from ..reports import made_by, write_csv, write_json

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
        ``command``, ``date``, ``machine``, ``settings`` and ``reductions``: what the JSON file holds.

    Raises
    ------
    MissingPackageError
        Without Blender.
    """
    try:
        from ...blender.blend_files import BLENDER_VERSION
        from ...blender.motion.reduction_comparison import compare_reductions
    except ImportError:
        raise MissingPackageError("Blender's Python module bpy", "blender") from None

    progress("reductions")
    rows = compare_reductions(MILLIMETRES, DEGREES, args.seed)
    settings = {"millimetres": MILLIMETRES, "degrees": DEGREES, "seed": args.seed}
    report = {
        **made_by(),
        "settings": settings | {"blender": BLENDER_VERSION},
        "reductions": rows,
    }
    with filling(folder) as draft:
        write_json(draft / "motion.json", report)
        write_csv(draft / "motion.csv", rows)
    return report
