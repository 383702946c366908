"""``unisg benchmark paper``: makes the scenes, trains what has not been trained, writes tables and figures."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from ...errors import UniSGError
from ...learn.paper.experiment_scenes import make_data
from ...runtime.made_files import filling
from ...runtime.process_pool import processors
from ..reports import claim_folder, machine, write_csv, write_json
from .paper_figures import draw_errors, draw_panels
from .paper_tables import Table, make_tables, to_markdown
from .plan import QUICK_PLAN, PaperPlan, all_runs
from .run_tables import rounded, run_tables
from .runs import finished, run_all

MARKDOWN: dict[str, tuple[str, dict[str, str]]] = {
    "classification": ("The paper's classification, last epoch (mean ± standard deviation over runs)", {
        "form": "form", "runs": "runs", "parameters": "parameters", "loss": "loss", "test_loss": "held-out loss",
        "test_accuracy": "held-out accuracy",
    }),
    "generation": ("The paper's generation, last epoch", {
        "form": "form", "runs": "runs", "parameters": "parameters", "mse": "MSE", "bce": "BCE", "kl": "KL",
        "test_mse": "held-out MSE", "test_bce": "held-out BCE",
    }),
    "topology": ("The paper's topology, last epoch", {
        "form": "form", "runs": "runs", "parameters": "parameters", "loss": "loss", "test_loss": "held-out loss",
        "test_average_precision": "held-out average precision", "test_roc_area": "held-out ROC area",
    }),
    "generation_decoded": ("The same CGVAE, decoded: held-out rooms (95 % intervals)", {
        "form": "form", "seeds": "runs", "mse": "MSE", "mse_of_mean": "MSE of the mean", "mse_of_zeros": "of zeros",
        "r_squared": "R²", "cm_median": "cm, median", "cm_p95": "cm, 95 %", "degrees_median": "degrees, median",
        "degrees_p95": "degrees, 95 %", "invalidity": "invalidity", "mean_cm_median": "cm of the mean",
        "mean_degrees_median": "degrees of the mean",
    }),
    "poses": ("Poses, one factor at a time (95 % intervals)", {
        "setting": "setting", "form": "form", "channels": "channels", "parameters": "parameters", "rate": "rate",
        "cm_median": "cm, median", "cm_p95": "cm, 95 %", "degrees_median": "degrees, median",
        "degrees_p95": "degrees, 95 %", "degrees_symmetric_median": "symmetry-aware", "mse": "own MSE",
        "mean_mse": "MSE of the mean", "zeros_mse": "of zeros", "r_squared": "R²", "invalidity": "invalidity",
        "mean_cm_median": "cm of the mean", "mean_degrees_median": "degrees of the mean",
    }),
    "topology_unseen": ("What stands on what in unseen scenes (95 % intervals)", {
        "rotation": "rotation", "method": "method", "form": "form", "seeds": "seeds", "parameters": "parameters",
        "average_precision": "average precision", "f1": "F1",
    }),
    "topology_scale": ("The shipped topology network on fields of cubes, one thread", {
        "cubes": "cubes", "candidates": "pairs", "seconds_candidates": "s, candidates", "seconds_network": "s, network",
        "megabytes": "MB of arrays", "missed": "missed by candidates", "f1": "F1",
    }),
    "classification_few": ("Classification from few scenes: accuracy (95 % intervals)", {
        "sees": "sees", "training_scenes": "scenes", "form": "form", "seeds": "seeds", "parameters": "parameters",
        "same noise": "same noise", "unseen noise": "unseen noise", "turned": "turned", "tumbled": "tumbled",
        "other rooms": "other rooms",
    }),
    "tests": ("Paired tests over seeds (Wilcoxon), p corrected within each setting and number (Holm)", {
        "table": "table", "setting": "setting", "number": "number", "form": "form", "against": "against",
        "difference": "difference", "p": "p", "p_holm": "p, corrected",
    }),
}  # fmt: skip
"""By table: title, and columns with their headings."""


def write_paper_report(args: argparse.Namespace, folder: Path, progress: Callable[[str], None]) -> dict[str, Any]:
    """Do what is missing and write all files; a second call goes on where the first was stopped.

    Parameters
    ----------
    args
        With ``quick``, ``jobs``, ``quiet``, ``tables_only`` and ``rates`` (None for the plan's).
    folder
        Gets ``data`` and ``runs`` (kept, so that a call after a kill goes on), tables and figures.
    progress
        Called with the name of each step.
    """
    plan = QUICK_PLAN if args.quick else PaperPlan()
    if args.rates:
        plan = replace(plan, rates=tuple(args.rates))
    jobs = args.jobs or processors()
    runs = all_runs(plan)
    if args.tables_only:
        results = finished(runs, folder)
        if not results:
            raise UniSGError(f"{folder} has no finished training: run without --tables-only first")
    else:
        folder.mkdir(parents=True, exist_ok=True)
        claim_folder(folder, bool(args.quick))
        make_data(folder / "data", plan.sizes, jobs, progress)
        progress(f"{len(runs)} trainings")
        results = run_all(runs, folder, jobs, args.quiet)
    progress("tables and figures")
    single = run_tables(results, plan)
    tables = make_tables(single, results, plan)
    report = {
        "command": "unisg benchmark paper" + (" --quick" if args.quick else ""),
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "machine": machine(),
        "trainings": {"planned": len(runs), "done": len(results)},
        "rates": list(plan.rates),
        "processor_seconds": round(sum(record["seconds"] for record in results.values()), 1),
        "tables": tables,
    }
    _write(folder, report, tables, single)
    return report


def _write(folder: Path, report: dict[str, Any], tables: dict[str, Table], single: dict[str, Table]) -> None:
    with filling(folder) as draft:
        kept = {key: table for key, table in tables.items() if not key.endswith("_curves")}
        write_json(draft / "paper.json", report | {"tables": kept})
        for key, rows in tables.items():
            if rows:
                write_csv(draft / f"paper_{key}.csv", rows)
        for key, rows in single.items():
            if rows:
                write_csv(draft / f"paper_{key}_runs.csv", [_short(row) for row in rows])
        pages = [
            f"## {title}\n\n{to_markdown(tables[key], columns)}\n"
            for key, (title, columns) in MARKDOWN.items()
            if tables[key]
        ]
        (draft / "paper_tables.md").write_text("\n".join(pages), encoding="utf-8")
        draw_panels(tables, [draft / "paper.png", draft / "paper.svg"])
        draw_errors(tables, [draft / "paper_poses.png", draft / "paper_poses.svg"])


def _short(row: dict[str, Any]) -> dict[str, Any]:
    """A row with five digits of each number."""
    return {name: rounded(value) if isinstance(value, float) else value for name, value in row.items()}
