"""A timeline as a picture: one row per action, from its opening to its performance."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from ...runtime.matplotlib_figure import new_figure

OPEN, DONE, EARLY, WRONG = "#f0c36d", "#2e8b57", "#c0392b", "#8e44ad"


def draw_timeline(record: Mapping[str, Any], path: str | os.PathLike[str]) -> None:
    """Draw what :func:`~.timeline.timeline_record` returns into a file (.png, .svg ...).

    Raises
    ------
    MissingPackageError
        Without matplotlib.
    """
    rows = [node for node in record["nodes"] if node["kind"] != "operation"]
    figure = new_figure(11, 1.6 + 0.26 * len(rows))
    axes = figure.add_subplot()
    for place, node in enumerate(rows):
        _draw_node(axes, place, node, record["end"])
    _draw_feedback(axes, rows, record["events"])
    axes.set_yticks(range(len(rows)), [_label(node) for node in rows])
    for text, node in zip(axes.get_yticklabels(), rows, strict=True):
        text.set_fontweight("bold" if node["kind"] != "action" else "normal")
        text.set_color("#999999" if node["status"] in ("skipped", "waiting") else "black")
        text.set_horizontalalignment("left")
    axes.tick_params(axis="y", pad=230, length=0)
    axes.invert_yaxis()
    axes.set_xlim(record["start"], max(record["end"], record["start"] + 1e-3))
    axes.set_xlabel("time in s")
    axes.grid(axis="x", color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.set_title(
        f"{record['operation']}: {'played to the end' if record['finished'] else 'not finished'}", loc="left"
    )
    for color, marker, label in ((DONE, "o", "performed"), (EARLY, "x", "out of order"), (WRONG, "s", "wrong answer")):
        axes.plot([], [], marker, color=color, label=label)
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=3, frameon=False, fontsize="small")
    figure.savefig(path, dpi=120)


def _label(node: Mapping[str, Any]) -> str:
    name = node["name"] if len(node["name"]) <= 34 else node["name"][:33] + "…"
    return "    " * (node["depth"] - 1) + name + (" (optional)" if node["optional"] else "")


def _draw_node(axes: Any, place: int, node: Mapping[str, Any], end: float) -> None:
    if node["opened"] is None:
        return
    stop = node["done"] if node["done"] is not None else end
    thick = 0.5 if node["kind"] == "action" else 0.16
    axes.barh(place, stop - node["opened"], left=node["opened"], height=thick, color=OPEN)
    if node["done"] is not None and node["kind"] == "action":
        axes.plot(node["done"], place, "o", color=DONE)


def _draw_feedback(axes: Any, rows: list[Mapping[str, Any]], events: list[Mapping[str, Any]]) -> None:
    place_of = {node["uid"]: place for place, node in enumerate(rows)}
    for event in events:
        if event["kind"] in ("out_of_order", "wrong_answer"):
            early = event["kind"] == "out_of_order"
            axes.plot(event["time"], place_of[event["uid"]], "x" if early else "s", color=EARLY if early else WRONG)
