"""The figures of the experiments: curves like the paper's three panels, and decoded errors by form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..figures import figure_of, save_figure
from .paper_tables import Table

PANELS = (
    ("classification", "loss", "Classification: training loss"),
    ("generation", "loss", "Generation: training loss"),
    ("topology", "loss", "Topology: training loss"),
    ("classification", "test_accuracy", "Classification: accuracy, held-out scenes"),
    ("generation", "test_mse", "Generation: MSE in the form's space, held out"),
    ("topology", "test_average_precision", "Topology: average precision, held-out edges"),
)
"""Experiment, curve and title of each panel: the paper's three, and below what they leave open."""

SHARES = ("test_accuracy", "test_average_precision")
"""Curves that cannot be above 1: neither is their band."""

FACTORS = ("target, base case", "target, large translations", "input, base case", "in and out, parent-relative")


def draw_panels(tables: Mapping[str, Table], paths: Sequence[Path]) -> None:
    """Mean over runs and its standard deviation as a band, by epoch, for the five forms.

    Raises
    ------
    MissingPackageError
        Without matplotlib.
    """
    figure, places = figure_of((13, 7), 2, 3)
    for axes, (experiment, name, title) in zip(places, PANELS, strict=True):
        rows = tables[f"{experiment}_curves"]
        for form in dict.fromkeys(row["form"] for row in rows):
            own = [row for row in rows if row["form"] == form]
            epochs, mean = [row["epoch"] for row in own], np.array([row[name] for row in own])
            spread = np.array([row[f"{name}_std"] for row in own])
            line = axes.plot(epochs, mean, label=f"{form} ({own[0]['runs']} runs)", linewidth=1.2)[0]
            low, high = mean - spread, mean + spread
            if name in SHARES:
                high = np.minimum(high, 1.0)
            axes.fill_between(epochs, low, high, color=line.get_color(), alpha=0.18, linewidth=0)
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("epoch")
        if rows:
            axes.legend(fontsize=7, frameon=False)
        if experiment == "generation" and rows:
            axes.set_yscale("log")
    save_figure(figure, paths)


def draw_errors(tables: Mapping[str, Table], paths: Sequence[Path]) -> None:
    """Median errors in centimetres and degrees by form, with 95 % confidence intervals."""
    there = {row["setting"] for row in tables["poses"]}
    factors = [factor for factor in FACTORS if factor in there] or [FACTORS[0]]
    figure, places = figure_of((13, 7), 2, len(factors))
    for column, factor in enumerate(factors):
        rows = [row for row in tables["poses"] if row["setting"] == factor]
        names = [row["form"] for row in rows]
        for line, (name, unit) in enumerate((("cm_median", "centimetres"), ("degrees_median", "degrees"))):
            axes = places[line * len(factors) + column]
            axes.barh(names, [row[name] for row in rows], xerr=[row[f"{name}_ci"] or 0 for row in rows], height=0.6)
            axes.invert_yaxis()
            axes.set_xlabel(f"median error, {unit}")
            if not line:
                axes.set_title(factor, fontsize=10)
    save_figure(figure, paths)
