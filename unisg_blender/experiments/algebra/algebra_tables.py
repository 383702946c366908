"""The tables of the comparison: one row for each training and test set, their means, and paired tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...metrics.seed_statistics import holm, interval, paired_test
from ..paper.paper_tables import grouped
from ..paper.run_tables import rounded
from ..paper.runs import Run
from ..reports import Table

BUDGETS = {"steps": "equal steps", "time": "equal time"}
"""By the name in a result: every network has as many parameters; either as many steps, or as much time."""

LONG = "more steps"
"""The budget of trainings that were given no time of their own, see :func:`.algebra_plan.long_runs`."""

KEYS = ("task", "tested", "budget", "rooms", "network")
REFERENCE = "relative"
"""The network that the others are compared with: poses relative to each other, in 6D."""

FEW = 100
"""Up to so many rooms are few; paired tests are over seeds and these numbers of rooms."""


def training_rows(runs: Sequence[Run], results: Mapping[str, Mapping[str, Any]]) -> Table:
    """The errors of every training that is there, by test set and budget."""
    table: Table = []
    for run in runs:
        result = results[run.key]["result"] if run.key in results else {}
        budgets = BUDGETS if run.settings["seconds"] else {"steps": LONG}
        for budget, title in budgets.items():
            tested = {name: value for name, value in result.get(budget, {}).items() if name not in ("step", "seconds")}
            table += [
                {
                    "task": run.settings["task"], "tested": name, "budget": title, "rooms": run.settings["rooms"],
                    "network": run.settings["network"], "seed": run.settings["seed"], "error": error,
                    "parameters": result["parameters"], "step": result[budget]["step"],
                    "seconds": result[budget]["seconds"],
                }
                for name, error in tested.items()
            ]  # fmt: skip
    return table


def mean_rows(rows: Table) -> Table:
    """Means over seeds with half the width of their 95 % intervals."""
    table = []
    for keys, group in grouped(rows, KEYS):
        errors = interval([row["error"] for row in group])
        table.append(
            keys
            | {"seeds": len(group), "error": rounded(errors["mean"]), "error_ci": rounded(errors["half_width"])}
            | {"parameters": group[0]["parameters"]}
            | {f"{name}_mean": rounded(np.mean([row[name] for row in group])) for name in ("step", "seconds")}
        )
    return table


def paired_rows(rows: Table) -> Table:
    """Each network against :data:`REFERENCE` with few rooms: Wilcoxon's test over pairs with the same rooms and seed.

    All tests of the table are one family: ``p_holm`` is corrected for how many there are. The rooms of a seed are
    among those of its larger numbers, so pairs of one seed are not quite independent.
    """
    family: Table = []
    few = [row for row in rows if row["rooms"] <= FEW and row["budget"] in BUDGETS.values()]
    for keys, group in grouped(few, KEYS[:3]):
        own = {name["network"]: {(row["rooms"], row["seed"]): row["error"] for row in part}
               for name, part in grouped(group, ("network",))}  # fmt: skip
        base = own.pop(REFERENCE, {})
        for network, errors in own.items():
            both = np.array([(errors[pair], base[pair]) for pair in errors if pair in base]).reshape(-1, 2)
            family.append(
                keys
                | {"network": network, "against": REFERENCE, "pairs": len(both)}
                | {"difference": rounded(np.mean(both[:, 0] - both[:, 1])) if len(both) else None}
                | {"better": int((both[:, 0] < both[:, 1]).sum()), "p": paired_test(both[:, 0], both[:, 1])}
            )
    corrected = holm([row["p"] for row in family])
    return [row | {"p": rounded(row["p"]), "p_holm": rounded(p)} for row, p in zip(family, corrected, strict=True)]
