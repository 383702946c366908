"""The tables of the experiments: one row per form and setting, means over seeds with 95 % intervals, and tests."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ...errors import UniSGError
from ...learn.paper.experiment_scenes import TESTS
from ...metrics.seed_statistics import bounded_interval, holm, interval, paired_test
from ..reports import Table, markdown_table
from .plan import PaperPlan, rule_runs, scale_runs
from .run_tables import LAST, MEAN_NUMBERS, Results, by_form, rounded, there

KEYS = {
    "generation_decoded": ("form",),
    "poses": ("setting", "form"),
    "topology_unseen": ("rotation", "method", "form"),
    "classification_few": ("sees", "training_scenes", "form"),
}
"""What makes up a row of a table, the form last."""

FIXED = ("width", "channels", "parameters", "rate", "zeros_mse")
"""Columns that are the same for all seeds of a row."""

SHARES = ("r_squared", "average_precision", "f1", *TESTS)
"""Columns whose values end at 1, and their intervals too."""

TESTED = {
    "generation_decoded": ("vector + angle-axis", ("cm_median", "degrees_median")),
    "poses": ("sixd", ("cm_median", "degrees_median")),
    "topology_unseen": ("sixd", ("average_precision", "f1")),
    "classification_few": ("sixd", ("unseen noise", "other rooms")),
}
"""By table: the form that the others are compared with, and the numbers that are compared."""


def make_tables(rows: Mapping[str, Table], results: Results, plan: PaperPlan) -> dict[str, Table]:
    """All tables by name, of the rows of single trainings; those without a single result are empty."""
    tables = {name: paper_table(rows[name], name) for name in LAST}
    tables |= {f"{name}_curves": curve_table(results, plan, name) for name in LAST}
    tables |= {name: summary_table(rows[name], keys) for name, keys in KEYS.items()}
    tables["topology_unseen"] = rule_table(results) + tables["topology_unseen"]
    return tables | {"topology_scale": scale_table(results, plan), "tests": test_table(rows)}


def grouped(rows: Table, keys: Sequence[str]) -> Iterator[tuple[dict[str, Any], Table]]:
    """Rows that agree in some columns, and those columns, in the order of their first row."""
    groups: dict[tuple[Any, ...], Table] = {}
    for row in rows:
        groups.setdefault(tuple(row[key] for key in keys), []).append(row)
    for values, group in groups.items():
        yield dict(zip(keys, values, strict=True)), group


def paper_table(rows: Table, experiment: str) -> Table:
    """After the last epoch: mean over runs and standard deviation."""
    table = []
    for keys, group in grouped(rows, ("form", "parameters")):
        row = keys | {"runs": len(group)}
        for name in LAST[experiment]:
            values = [run[name] for run in group]
            row |= {name: rounded(np.mean(values)), f"{name}_std": rounded(np.std(values))}
        table.append(row)
    return table


def curve_table(results: Results, plan: PaperPlan, experiment: str) -> Table:
    """Mean and standard deviation over runs after every epoch."""
    table = []
    for title, found in by_form(results, plan, experiment).items():
        curves = {name: np.array([run["curves"][name] for run in found.values()]) for name in LAST[experiment]}
        for epoch in range(len(next(iter(curves.values()))[0])):
            row: dict[str, Any] = {"form": title, "epoch": epoch + 1, "runs": len(found)}
            for name, values in curves.items():
                row |= {name: rounded(values[:, epoch].mean()), f"{name}_std": rounded(values[:, epoch].std())}
            table.append(row)
    return table


def summary_table(rows: Table, keys: Sequence[str]) -> Table:
    """Means over seeds; of shares ``_low`` and ``_high`` of the interval, of other numbers its half width ``_ci``.

    What always predicting the training mean costs has no interval: it is there to compare with.
    """
    table = []
    for values, group in grouped(rows, keys):
        row = values | {name: group[0][name] for name in FIXED if name in group[0]} | {"seeds": len(group)}
        for name in group[0]:
            if name in (*keys, *FIXED, "seed"):
                continue
            numbers = [run[name] for run in group]
            row[name] = rounded(np.mean(numbers))
            if name in SHARES:
                low, high = bounded_interval(numbers)
                row |= {f"{name}_low": rounded(low), f"{name}_high": rounded(high)}
            elif not name.startswith("mean_") or "setting" not in keys:
                row[f"{name}_ci"] = rounded(interval(numbers)["half_width"])
        table.append(row)
    return table


def rule_table(results: Results) -> Table:
    """What needs no training, on what stands on what in unseen scenes."""
    return [
        {"rotation": rotation, "method": name, "form": "", "seeds": 1}
        | {key: result[key] for key in ("candidates", "edges")}
        | {key: rounded(value) for key, value in row.items()}
        for rotation, run in rule_runs().items()
        for result in there([run], results)
        for name, row in result["rules"].items()
    ]


def scale_table(results: Results, plan: PaperPlan) -> Table:
    """What a field of cubes costs."""
    return [{"cubes": run.settings["cubes"], **result} for run in scale_runs(plan) for result in there([run], results)]


def test_table(rows: Mapping[str, Table]) -> Table:
    """Paired tests over seeds of each form against one, corrected within each setting and number.

    The seeds of all forms have the same data and the same draws. The reconstructions of the CGVAE are also compared
    with what always predicting the training mean would cost.
    """
    found: Table = []
    for table, (reference, numbers) in TESTED.items():
        for setting, group in grouped(rows[table], KEYS[table][:-1]):
            forms = {keys["form"]: own for keys, own in grouped(group, ("form",))}
            for name in numbers:
                others = {form: (own, forms[reference]) for form, own in forms.items() if reference in forms}
                others.pop(reference, None)
                found += _tests(table, ", ".join(map(str, setting.values())), name, reference, others)
    for name in MEAN_NUMBERS[:2]:
        own = {keys["form"]: group for keys, group in grouped(rows["generation_decoded"], ("form",))}
        means = {form: [row | {name: row[f"mean_{name}"]} for row in group] for form, group in own.items()}
        pairs = {form: (own[form], means[form]) for form in own}
        found += _tests("generation_decoded", "", name, "the training mean", pairs)
    return found


def _tests(table: str, setting: str, name: str, reference: str, pairs: Mapping[str, tuple[Table, Table]]) -> Table:
    """One family of tests: rows of each form beside those that they are compared with, seed by seed."""
    family: Table = []
    for form, (own, other) in pairs.items():
        by_seed = {row["seed"]: row[name] for row in other}
        both = np.array([(row[name], by_seed[row["seed"]]) for row in own if row["seed"] in by_seed], np.float64)
        first, second = both.reshape(-1, 2).T
        difference = rounded(np.mean(first - second)) if len(both) else None
        family.append({
            "table": table, "setting": setting, "number": name, "form": form, "against": reference,
            "pairs": len(both), "difference": difference, "p": paired_test(first, second),
        })  # fmt: skip
    corrected = holm([row["p"] for row in family])
    return [row | {"p": rounded(row["p"]), "p_holm": rounded(p)} for row, p in zip(family, corrected, strict=True)]


def to_markdown(table: Table, columns: Mapping[str, str]) -> str:
    """Rows as a Markdown table; a column with an interval beside it is written "mean ± half width", or with its ends.

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
    if value is None or value == "":
        return ""
    if isinstance(value, str | int):
        return str(value)
    if row.get(f"{name}_low") is not None:
        return f"{value:.3g} ({row[f'{name}_low']:.3g} to {row[f'{name}_high']:.3g})"
    spread = next((row[f"{name}{end}"] for end in ("_ci", "_std") if row.get(f"{name}{end}") is not None), None)
    shown = 0.0 if spread is not None and spread < 1e-6 else spread
    if row.get("runs") == 1:  # one run has no spread
        shown = None
    return f"{value:.3g}" + (f" ± {shown:.2g}" if shown is not None else "")
