"""Writes the meshes benchmark: one CSV per table, one JSON with everything, a figure, and a page of tables."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ...errors import UniSGError
from ...learn.atlasnet.world_shapes import world_models
from ...meshes.shape_files import ShapeFile, of_split, read_models
from ...runtime.made_files import filling
from ..reports import Table, made_by, markdown_table, write_csv, write_json
from .meshes_benchmark import (
    measure_categories,
    measure_reconstruction,
    measure_speed,
    measure_stability,
    split_sets,
)
from .meshes_figure import draw_meshes
from .meshes_scenes import measure_labelled_rooms, measure_unknown

WORLDS_WITH_OBJECTS = ("operating-room", "living-room")
PICTURED = ("Chair", "Sofa", "Table Lamp", "Bed", "Plant", "Cabinet")
"""Categories of which a held-out model is drawn."""
ROOMS = 12
"""Rooms of each world, as in training."""


def write_meshes_report(args: argparse.Namespace, folder: Path, progress: Callable[[str], None]) -> dict[str, Any]:
    """Measure, then write all files; nothing is written if a measurement fails.

    Parameters
    ----------
    args
        With ``data`` (folders of mesh files), ``repeats`` and ``seed`` (that of the training).
    folder
        Where the files go; made if it is not there.
    progress
        Called with the name of each step.
    """
    if not args.data:
        raise UniSGError("the meshes benchmark needs --data FOLDER... with mesh files, as 'unisg train meshes' does")
    models = read_models(args.data)
    unseen = {model.category for model in of_split(models, "unseen")}
    rooms = [m for m in world_models(WORLDS_WITH_OBJECTS, ROOMS, args.seed) if m.category not in unseen]
    tables = measure_all(models, rooms, args.repeats, progress)
    report = {**made_by(), "settings": {"seed": args.seed, "repeats": args.repeats}, "tables": tables}
    with filling(folder) as draft:
        write_json(draft / "meshes.json", report)
        (draft / "meshes.md").write_text(to_markdown(tables), encoding="utf-8")
        shown = {model.category: model for model in reversed(of_split(models, "test"))}
        draw_meshes([shown[name] for name in PICTURED if name in shown], [draft / "meshes.png"])
        for table, rows in tables.items():
            write_csv(draft / f"meshes_{table}.csv", rows)
    return report


def measure_all(
    models: list[ShapeFile], rooms: list[ShapeFile], repeats: int, progress: Callable[[str], None]
) -> dict[str, Table]:
    """All tables by name."""
    training = of_split(models, "train") + of_split(rooms, "train")
    sets = {name: found for name, found in split_sets(models, rooms).items() if found}
    progress("speed")
    tables = {"speed": measure_speed(repeats)}
    progress("stability")
    tables["stability"] = measure_stability(of_split(models, "test") + of_split(models, "unseen"))
    progress("categories")
    tables["categories"] = measure_categories(training, of_split(models, "test"))
    tables["rooms"] = measure_labelled_rooms(WORLDS_WITH_OBJECTS)
    tables["confidence"] = measure_unknown(of_split(models, "test"), of_split(models, "unseen"))
    tables["reconstruction"] = measure_reconstruction(training, sets, progress)
    return tables


def to_markdown(tables: dict[str, Table]) -> str:
    """The tables as Markdown."""
    pages = [
        f"## {name.capitalize()}\n\n{markdown_table(list(rows[0]), (list(map(str, row.values())) for row in rows))}\n"
        for name, rows in tables.items()
        if rows
    ]
    return "\n".join(pages)
