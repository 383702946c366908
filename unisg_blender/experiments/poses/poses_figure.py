"""The figure of the poses benchmark: time and worst error of every form."""

from __future__ import annotations

from pathlib import Path

from ..figures import figure_of
from ..reports import Table


def draw_poses(tables: dict[str, Table], paths: list[Path]) -> None:
    """Write the figure to each path, its format by the path's ending.

    Parameters
    ----------
    tables
        As ``measure_poses`` gives.
    paths
        Files to write (``.png``, ``.svg``).

    Raises
    ------
    MissingPackageError
        Without matplotlib.
    """
    figure, (left, right) = figure_of((11, 4.5), 1, 2)
    _draw_times(left, tables["speed"])
    _draw_errors(right, tables["exactness"])
    for path in paths:
        figure.savefig(path, dpi=150)


def _draw_times(axes, rows: Table) -> None:  # type: ignore[no-untyped-def]  # matplotlib's Axes, imported lazily
    times = {row["job"]: row["nanoseconds"] for row in rows}
    names = [job.removesuffix(" encode") for job in times if job.endswith(" encode")]
    places = range(len(names))
    axes.barh([p + 0.2 for p in places], [times[f"{n} encode"] for n in names], 0.4, label="encode")
    axes.barh([p - 0.2 for p in places], [times[f"{n} decode"] for n in names], 0.4, label="decode")
    axes.axvline(rows[0]["nanoseconds"], color="black", linewidth=1, linestyle="--", label="scipy matrix to quaternion")
    axes.set_yticks(list(places), names)
    axes.invert_yaxis()
    axes.set_xlabel("nanoseconds per rigid pose, one thread")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3, frameon=False)


def _draw_errors(axes, rows: Table) -> None:  # type: ignore[no-untyped-def]
    chosen = [row for row in rows if row["poses"] == "general"]
    places = range(len(chosen))
    for shift, precision in ((0.2, "float64"), (-0.2, "float32")):
        worst = [max(row[f"linear_{precision}"], row[f"translation_{precision}"], 1e-17) for row in chosen]
        axes.barh([p + shift for p in places], worst, 0.4, label=precision)
    axes.axvline(1e-12, color="black", linewidth=1, linestyle=":")
    axes.axvline(1e-6, color="black", linewidth=1, linestyle=":", label="promised")
    axes.set_xscale("log")
    axes.set_yticks(list(places), [row["form"] for row in chosen])
    axes.invert_yaxis()
    axes.set_xlabel("worst relative error of a round trip, any affine, with stretch")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3, frameon=False)
