"""The figure of the comparison: error against the number of rooms, one line for each network."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..figures import figure_of, save_figure
from ..paper.paper_tables import grouped
from ..reports import Table
from .algebra_tables import BUDGETS

COLOURS = {
    "absolute": "#888888", "absolute, turned": "#c0504d", "relative": "#1f4e79", "EGNN": "#e6a117", "PGA": "#5b9e48",
    "PGA, upright": "#8064a2",
}  # fmt: skip
FEWEST = 3
"""Seeds from which on an interval says something."""

AXES = {"completion": "nats a place", "kinds": "share of rooms wrong", "foreign kinds": "share of rooms wrong"}


def draw_algebra(means: Table, paths: Sequence[Path]) -> None:
    """One row for each task and set of turned test rooms; equal steps left, equal time right.

    Bands are 95 % intervals, of :data:`FEWEST` seeds or more.

    Raises
    ------
    MissingPackageError
        Without matplotlib.
    """
    lines = [(keys, part) for keys, part in grouped(means, ("task", "tested")) if keys["tested"].endswith("turned")]
    figure, places = figure_of((11, 2.9 * len(lines) + 0.4), max(1, len(lines)), len(BUDGETS))
    for line, (keys, part) in enumerate(lines):
        for column, title in enumerate(BUDGETS.values()):
            axes = places[line * len(BUDGETS) + column]
            for name, group in grouped([row for row in part if row["budget"] == title], ("network",)):
                rooms, error = (np.array([row[key] for row in group], float) for key in ("rooms", "error"))
                half = np.array([row["error_ci"] or 0 if row["seeds"] >= FEWEST else 0 for row in group])
                colour = COLOURS[name["network"]]
                axes.plot(rooms, error, "o-", ms=3, lw=1.4, color=colour, label=name["network"])
                axes.fill_between(rooms, error - half, error + half, color=colour, alpha=0.13, linewidth=0)
            axes.set_xscale("log")
            axes.set_xticks(
                sorted({row["rooms"] for row in part}), sorted({str(row["rooms"]) for row in part}, key=int)
            )
            axes.minorticks_off()
            axes.set_title(f"{keys['task']}: {keys['tested']} ({title})", fontsize=9)
            axes.set_ylabel(AXES.get(keys["task"], "1 - average precision"), fontsize=8)
            axes.set_xlabel("rooms to learn from", fontsize=8)
    for axes in [axes for axes in places if axes.get_legend_handles_labels()[0]][:1]:
        axes.legend(fontsize=7, frameon=False, ncols=2)
    save_figure(figure, paths)
