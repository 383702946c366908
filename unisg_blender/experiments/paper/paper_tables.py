"""The tables of the experiments: one row per form and setting, means over seeds with 95 % confidence intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...errors import UniSGError
from ...learn.paper.experiment_scenes import TESTS
from ...metrics.pose_errors import interval
from ..reports import Table, markdown_table
from .plan import PAPER_FORMS, PaperPlan, few_runs, link_runs, pair_runs, paper_runs, pose_runs, rule_runs, scale_runs
from .runs import Run

Results = Mapping[str, Mapping[str, Any]]
"""What :func:`.runs.run_all` gave, by key; runs that are not there are left out of the tables."""

LAST = {
    "classification": ("loss", "accuracy", "test_loss", "test_accuracy"),
    "topology": ("loss", "average_precision", "test_loss", "test_average_precision", "test_roc_area"),
    "generation": ("loss", "mse", "bce", "kl", "test_loss", "test_mse", "test_bce", "test_kl"),
}
"""Curves of the paper's experiments, by experiment."""

POSE_NUMBERS = (
    "cm_median", "cm_p95", "degrees_median", "degrees_p95", "degrees_symmetric_median", "degrees_symmetric_p95",
    "points_cm", "mse", "r_squared", "invalidity",
)  # fmt: skip


def make_tables(results: Results, plan: PaperPlan) -> dict[str, Table]:
    """All tables by name; those without a single result are empty."""
    tables = {name: paper_table(results, plan, name) for name in LAST}
    tables |= {f"{name}_curves": curve_table(results, plan, name) for name in LAST}
    return tables | {
        "generation_decoded": decoded_table(results, plan),
        "poses": pose_table(results, plan),
        "topology_unseen": unseen_table(results, plan),
        "topology_scale": scale_table(results, plan),
        "classification_few": few_table(results, plan),
    }


def _there(runs: Sequence[Run], results: Results) -> list[Mapping[str, Any]]:
    return [results[run.key]["result"] for run in runs if run.key in results]


def by_form(results: Results, plan: PaperPlan, experiment: str) -> dict[str, list[Mapping[str, Any]]]:
    """Results of one of the paper's experiments by the name of the form, those forms that have any."""
    found = {}
    for title, form in PAPER_FORMS.items():
        runs = [run for run in paper_runs(plan) if run.experiment == experiment and run.settings["form"] == form]
        if there := _there(runs, results):
            found[title] = there
    return found


def paper_table(results: Results, plan: PaperPlan, experiment: str) -> Table:
    """After the last epoch: mean over runs and standard deviation."""
    table = []
    for title, found in by_form(results, plan, experiment).items():
        row: dict[str, Any] = {"form": title, "runs": len(found), "parameters": found[0]["parameters"]}
        for name in LAST[experiment]:
            values = [result["curves"][name][-1] for result in found]
            row |= {name: rounded(np.mean(values)), f"{name}_std": rounded(np.std(values))}
        table.append(row)
    return table


def curve_table(results: Results, plan: PaperPlan, experiment: str) -> Table:
    """Mean and standard deviation over runs after every epoch."""
    table = []
    for title, found in by_form(results, plan, experiment).items():
        curves = {name: np.array([result["curves"][name] for result in found]) for name in LAST[experiment]}
        for epoch in range(len(next(iter(curves.values()))[0])):
            row: dict[str, Any] = {"form": title, "epoch": epoch + 1, "runs": len(found)}
            for name, values in curves.items():
                row |= {name: rounded(values[:, epoch].mean()), f"{name}_std": rounded(values[:, epoch].std())}
            table.append(row)
    return table


def with_intervals(rows: Sequence[Mapping[str, float]], names: Sequence[str]) -> dict[str, Any]:
    """Mean and half width of the 95 % confidence interval of each number that the rows (one per seed) have."""
    result: dict[str, Any] = {"seeds": len(rows)}
    for name in names:
        if name in rows[0]:
            found = interval([row[name] for row in rows])
            result |= {name: rounded(found["mean"]), f"{name}_ci": rounded(found["half_width"])}
    return result


def decoded_table(results: Results, plan: PaperPlan) -> Table:
    """What the CGVAE reconstructs in held-out rooms, decoded; beside it the training mean and zeros."""
    table = []
    for title, found in by_form(results, plan, "generation").items():
        rows = [result["decoded"] for result in found]
        names = [name for name in rows[0] if not name.startswith("mean_degrees_p95")]
        table.append({"form": title, **with_intervals(rows, names)})
    return table


def pose_table(results: Results, plan: PaperPlan) -> Table:
    """Forms as targets, as inputs and as both, one factor at a time."""
    table = []
    for (factor, form), run in pose_runs(plan).items():
        for result in _there([run], results):
            mean = {
                name: interval([row[name] for row in result["predict_mean"]])["mean"]
                for name in ("cm_median", "degrees_median", "mse")
            }
            table.append({
                "setting": factor, "form": form, "width": result["width"], "channels": result["channels_learned"],
                "parameters": result["parameters"], "rate": result["rate"],
                **with_intervals(result["rows"], POSE_NUMBERS),
                **{f"mean_{name}": rounded(value) for name, value in mean.items()},
                "zeros_mse": rounded(result["mse_of_zeros"]),
            })  # fmt: skip
    return table


def unseen_table(results: Results, plan: PaperPlan) -> Table:
    """What stands on what in unseen scenes: rules, the paper's autoencoder, networks over pairs."""
    table: Table = []
    for rotation, run in rule_runs().items():
        for result in _there([run], results):
            shared = {"rotation": rotation, "seeds": 1, "candidates": result["candidates"], "edges": result["edges"]}
            table += [
                {"method": name, "form": "", **shared, **{key: rounded(value) for key, value in row.items()}}
                for name, row in result["rules"].items()
            ]
    for form, runs in link_runs(plan).items():
        if found := _there(runs, results):
            rows = [result["rows"][0] for result in found]
            table.append(
                {
                    "method": "the paper's autoencoder",
                    "form": form,
                    "rotation": "full",
                    "parameters": found[0]["parameters"],
                    **with_intervals(rows, ("average_precision", "f1")),
                }
            )
    for (rotation, poses, form), run in pair_runs(plan).items():
        for result in _there([run], results):
            name = {"absolute": "pairs, two world poses", "relative": "pairs, relative pose"}.get(
                poses, "pairs, shipped features"
            )
            row = {"method": name, "form": form, "rotation": rotation, "parameters": result["parameters"]}
            table.append(row | with_intervals(result["rows"], ("average_precision", "f1")))
    return table


def scale_table(results: Results, plan: PaperPlan) -> Table:
    """What a field of cubes costs."""
    return [{"cubes": run.settings["cubes"], **result} for run in scale_runs(plan) for result in _there([run], results)]


def few_table(results: Results, plan: PaperPlan) -> Table:
    """Classification from few training scenes: accuracy in five sets of test scenes."""
    table = []
    for (see, count, form), runs in few_runs(plan).items():
        if found := _there(runs, results):
            rows = [result["tests"] for result in found]
            table.append(
                {
                    "sees": see,
                    "training_scenes": count,
                    "form": form,
                    "parameters": found[0]["parameters"],
                    **with_intervals(rows, TESTS),
                }
            )
    return table


def rounded(value: Any) -> float | None:
    """Five significant digits; None for what is no number."""
    number = float(value)
    return float(f"{number:.5g}") if np.isfinite(number) else None


def to_markdown(table: Table, columns: Mapping[str, str]) -> str:
    """Rows as a Markdown table; a column with an interval beside it is written "mean ± half width".

    Raises
    ------
    UniSGError
        If the table is empty.
    """
    if not table:
        raise UniSGError("there is nothing to write a table of: no training has finished")
    return markdown_table(list(columns.values()), ([_cell(row, name) for name in columns] for row in table))


def _cell(row: Mapping[str, Any], name: str) -> str:
    value = row.get(name)
    if value is None:
        return ""
    if isinstance(value, str | int):
        return str(value)
    spread = next((row[f"{name}{end}"] for end in ("_ci", "_std") if row.get(f"{name}{end}") is not None), None)
    shown = 0.0 if spread is not None and spread < 1e-6 else spread
    if row.get("runs") == 1:  # one run has no spread
        shown = None
    return f"{value:.3g}" + (f" ± {shown:.2g}" if shown is not None else "")
