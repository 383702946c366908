"""``unisg benchmark algebra``: makes the rooms, trains what has not been trained, writes tables and a figure."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from ...errors import UniSGError
from ...formats.layout_scenes import asset_folder, layout_scenes
from ...formats.layouts.procthor_houses import room_types
from ...learn.symmetry.compared_rooms import make_rooms
from ...learn.symmetry.room_arrays import RoomArrays
from ...runtime.made_files import filling
from ...runtime.process_pool import processors
from ...scene import SceneGraph
from ..paper.runs import finished, run_all
from ..reports import Table, claim_folder, made_by, write_csv, write_json
from .algebra_figure import draw_algebra
from .algebra_plan import QUICK_PLAN, AlgebraPlan, algebra_runs, long_runs
from .algebra_tables import mean_rows, paired_rows, training_rows

HOUSES = "oneroom.jsonl.gz"


def write_algebra_report(args: argparse.Namespace, folder: Path, progress: Callable[[str], None]) -> dict[str, Any]:
    """Do what is missing and write all files; a second call goes on where the first was stopped.

    Parameters
    ----------
    args
        With ``quick``, ``jobs``, ``quiet``, ``tables_only``, and ``data``: a folder with ProcTHOR's houses, or None.
    folder
        Gets ``data`` and ``runs`` (kept, so that a call after a kill goes on), tables and the figure.
    progress
        Called with the name of each step.

    Raises
    ------
    UniSGError
        No such houses, or with ``tables_only`` nothing to make tables of.
    """
    plan, jobs = QUICK_PLAN if args.quick else AlgebraPlan(), args.jobs or processors()
    if args.data and not (args.data[0] / HOUSES).is_file():
        raise UniSGError(f"give the folder of ProcTHOR's houses: --data FOLDER with {HOUSES}")
    data = folder / "data"
    if not args.tables_only:
        folder.mkdir(parents=True, exist_ok=True)
        claim_folder(folder, bool(args.quick))
        make_rooms(data, max(plan.rooms), plan.tests, houses(args.data, data), jobs, progress)
    runs = algebra_runs(plan, (data / "foreign-train.npz").is_file()) + long_runs(plan)
    if args.tables_only:
        results = finished(runs, folder)
        if not results:
            raise UniSGError(f"{folder} has no finished training: run without --tables-only first")
    else:
        progress(f"{len(runs)} trainings")
        results = run_all(runs, folder, jobs, args.quiet)
    rows = training_rows(runs, results)
    report = made_by() | {
        "plan": plan.__dict__, "trainings": {"planned": len(runs), "done": len(results)},
        "processor_seconds": round(sum(record["seconds"] for record in results.values())),
        "data": {path.stem: _size(RoomArrays.load(path)) for path in sorted(data.glob("*.npz"))},
    }  # fmt: skip
    progress("tables and figure")
    _write(folder, report, rows)
    return report


def houses(folders: Sequence[Path] | None, data: Path) -> Iterator[tuple[SceneGraph, int]]:
    """ProcTHOR's rooms with the number of their kind, where a folder is given and they have not been read yet."""
    if not folders or (data / "foreign-test.npz").is_file():
        return
    path = folders[0] / HOUSES
    graphs = [house.graph for house in layout_scenes(path, asset_folder(path))]
    kinds = sorted({room_types(graph) for graph in graphs})
    yield from ((graph, kinds.index(room_types(graph))) for graph in graphs)


def _size(rooms: RoomArrays) -> dict[str, int]:
    missed = int(rooms.missed.sum())
    return {"rooms": len(rooms), "objects": len(rooms.half), "supports": int(rooms.on.sum()) + missed, "missed": missed}


def _write(folder: Path, report: dict[str, Any], rows: Table) -> None:
    means = mean_rows(rows)
    with filling(folder) as draft:
        write_json(draft / "algebra.json", report)
        for name, table in (("runs", rows), ("means", means), ("tests", paired_rows(rows))):
            write_csv(draft / f"algebra_{name}.csv", table)
        draw_algebra(means, [draft / "algebra.png", draft / "algebra.svg"])
