"""Writes the generator's table: Markdown, CSV, JSON and a figure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ...runtime.made_files import filling
from ..reports import markdown_table, write_csv, write_json
from .benchmark_columns import TableRow

COLUMNS = {
    "colliding": ("collide %", 100, 1), "overlapping": ("overlap %", 100, 1), "off_support": ("float %", 100, 1),
    "outside": ("outside %", 100, 1), "refused": ("refused %", 100, 1), "on_top_of": ("on top", 1, 2),
    "beside": ("beside", 1, 2), "c2st_objects_0.03": ("C2ST object, 3 cm", 1, 2),
    "c2st_pairs_0.03": ("pair, 3 cm", 1, 2), "c2st_scene_0.03": ("scene, 3 cm", 1, 2),
    "c2st_objects_0.01": ("object, 1 cm", 1, 2), "c2st_pairs_0.01": ("pair, 1 cm", 1, 2),
    "c2st_scene_0.01": ("scene, 1 cm", 1, 2), "novelty": ("novelty", 1, 2), "diversity": ("diversity", 1, 2),
    "completion_cm": ("completion cm", 1, 1), "completion_degrees": ("degrees", 1, 0),
    "p_model_better": ("p (model better)", 1, 4), "nll": ("NLL", 1, 2), "parent_kind": ("parent kind", 1, 2),
    "parent_same": ("parent", 1, 2), "behaviour": ("behaviour", 1, 2), "milliseconds": ("ms / object", 1, 1),
}  # fmt: skip
"""Heading, factor and digits of each value; those that no row has are left out."""


def table(rows: Sequence[TableRow]) -> str:
    """The rows as a Markdown table; "±" is the standard deviation between seeds."""
    known = [name for name in COLUMNS if any(name in row.to_record()["values"] for row in rows)]
    head = ["", "seeds x scenes", *(COLUMNS[name][0] for name in known)]
    lines = ([row.name, f"{row.seeds} x {row.scenes}", *(_cell(row, name) for name in known)] for row in rows)
    return markdown_table(head, lines)


def _cell(row: TableRow, name: str) -> str:
    record = row.to_record()
    if name not in record["values"]:
        return ""
    _, factor, digits = COLUMNS[name]
    text = f"{factor * record['values'][name]:.{digits}f}"
    spread = factor * record["spread"].get(name, 0.0)
    return f"{text} ± {spread:.{digits}f}" if round(spread, digits) > 0 and not name.startswith("p_") else text


def write_report(rows: Sequence[TableRow], facts: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Write ``table.md``, ``table.csv``, ``table.json`` and ``table.png``, whole or not at all.

    The figure is left out where there is no matplotlib.

    Returns
    -------
    dict
        What the JSON file holds: the facts, and the rows.
    """
    report = {**facts, "rows": [row.to_record() for row in rows]}
    with filling(folder) as draft:
        (draft / "table.md").write_text(table(rows) + "\n", encoding="utf-8")
        write_json(draft / "table.json", report)
        write_csv(draft / "table.csv", [line for row in rows for line in _values(row)])
        try:
            _draw(rows, draft / "table.png")
        except ImportError:
            (draft / "table.png").unlink(missing_ok=True)
    return report


def _values(row: TableRow) -> Iterator[dict[str, Any]]:
    """One line per value of a row: mean, spread between seeds, and the interval by scene."""
    record = row.to_record()
    for name, value in record["values"].items():
        low, high = record["interval"].get(name, ("", ""))
        yield {
            "row": row.name, "seeds": row.seeds, "scenes": row.scenes, "objects": row.objects, "value": name,
            "mean": value, "spread": record["spread"].get(name, ""), "low": low, "high": high,
        }  # fmt: skip


FIGURE = ("colliding", "off_support", "c2st_objects_0.03", "c2st_scene_0.03", "novelty", "completion_cm")


def _draw(rows: Sequence[TableRow], path: Path) -> None:
    """Bars of the main values with their intervals."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, len(FIGURE), figsize=(3 * len(FIGURE), 0.35 * len(rows) + 1.2), sharey=True)
    names = [row.name for row in rows]
    for axis, name in zip(axes, FIGURE, strict=True):
        title, factor, _ = COLUMNS[name]
        values = [factor * row.to_record()["values"].get(name, 0.0) for row in rows]
        axis.barh(names, values, color=["#888888" if "real" in row.name else "#4477aa" for row in rows])
        for place, row in enumerate(rows):
            if name in row.interval:
                low, high = row.interval[name]
                axis.plot([factor * low, factor * high], [place, place], color="black", linewidth=1)
        axis.set_title(title, fontsize=9)
    axes[0].invert_yaxis()
    figure.tight_layout()
    figure.savefig(path, dpi=100)
    pyplot.close(figure)
