"""The values of every single training, one row per seed: what means, intervals and tests are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...learn.paper.experiment_scenes import TESTS
from ..reports import Table
from .plan import PAPER_FORMS, PaperPlan, few_runs, link_runs, pair_runs, paper_runs, pose_runs
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
MEAN_NUMBERS = ("cm_median", "degrees_median", "mse")
PAIR_METHODS = {
    "absolute": "pairs, two world poses", "relative": "pairs, relative pose", "shipped": "pairs, shipped features",
}  # fmt: skip


def run_tables(results: Results, plan: PaperPlan) -> dict[str, Table]:
    """By the name of the table that is made of them."""
    return {
        **{name: paper_rows(results, plan, name) for name in LAST},
        "generation_decoded": decoded_rows(results, plan),
        "poses": pose_rows(results, plan),
        "topology_unseen": unseen_rows(results, plan),
        "classification_few": few_rows(results, plan),
    }


def there(runs: Sequence[Run], results: Results) -> list[Mapping[str, Any]]:
    """The results of those runs that have finished."""
    return [results[run.key]["result"] for run in runs if run.key in results]


def by_form(results: Results, plan: PaperPlan, experiment: str) -> dict[str, dict[int, Mapping[str, Any]]]:
    """Results of one of the paper's experiments by the name of the form and by seed, those forms that have any."""
    found: dict[str, dict[int, Mapping[str, Any]]] = {}
    titles = {form: title for title, form in PAPER_FORMS.items()}
    for run in paper_runs(plan):
        if run.experiment == experiment and run.key in results:
            own = found.setdefault(titles[run.settings["form"]], {})
            own[run.settings["seed"]] = results[run.key]["result"]
    return {title: found[title] for title in PAPER_FORMS if title in found}


def paper_rows(results: Results, plan: PaperPlan, experiment: str) -> Table:
    """After the last epoch."""
    return [
        {"form": title, "seed": seed, "parameters": result["parameters"]}
        | {name: result["curves"][name][-1] for name in LAST[experiment]}
        for title, found in by_form(results, plan, experiment).items()
        for seed, result in found.items()
    ]


def decoded_rows(results: Results, plan: PaperPlan) -> Table:
    """What the CGVAE reconstructs in held-out rooms, decoded; beside it the training mean and zeros."""
    return [
        {"form": title, "seed": seed}
        | {name: value for name, value in result["decoded"].items() if name != "mean_degrees_p95"}
        for title, found in by_form(results, plan, "generation").items()
        for seed, result in found.items()
    ]


def pose_rows(results: Results, plan: PaperPlan) -> Table:
    """Forms as targets, as inputs and as both, one factor at a time."""
    return [
        {
            "setting": factor, "form": form, "seed": seed, "width": result["width"],
            "channels": result["channels_learned"], "parameters": result["parameters"], "rate": result["rate"],
            **{name: row[name] for name in POSE_NUMBERS if name in row},
            **{f"mean_{name}": result["predict_mean"][seed][name] for name in MEAN_NUMBERS},
            "zeros_mse": rounded(result["mse_of_zeros"]),
        }
        for (factor, form), run in pose_runs(plan).items()
        for result in there([run], results)
        for seed, row in enumerate(result["rows"])
    ]  # fmt: skip


def unseen_rows(results: Results, plan: PaperPlan) -> Table:
    """What stands on what in unseen scenes: the paper's autoencoder, and networks over pairs."""
    table = [
        {"method": "the paper's autoencoder", "form": form, "rotation": "full", "seed": run.settings["seed"]}
        | {"parameters": result["parameters"], **result["rows"][0]}
        for form, runs in link_runs(plan).items()
        for run in runs
        for result in there([run], results)
    ]
    return table + [
        {"method": PAIR_METHODS[poses], "form": form, "rotation": rotation, "seed": seed}
        | {"parameters": result["parameters"], "rate": result["rate"], **row}
        for (rotation, poses, form), run in pair_runs(plan).items()
        for result in there([run], results)
        for seed, row in enumerate(result["rows"])
    ]


def few_rows(results: Results, plan: PaperPlan) -> Table:
    """Classification from few training scenes: accuracy in five sets of test scenes."""
    return [
        {"sees": see, "training_scenes": count, "form": form, "seed": run.settings["seed"]}
        | {"parameters": result["parameters"], **{name: result["tests"][name] for name in TESTS}}
        for (see, count, form), runs in few_runs(plan).items()
        for run in runs
        for result in there([run], results)
    ]


def rounded(value: Any) -> float | None:
    """Five significant digits; None for what is no number."""
    number = float(value)
    return float(f"{number:.5g}") if np.isfinite(number) else None
