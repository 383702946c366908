"""The page after a training from few rooms: what is known well, hardly and not, and what to add."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from ...runtime.atomic_files import write_file
from ...runtime.wording import first_lines

SUFFIX = ".report.html"
ENOUGH, SEEN = 10, 3
"""Rooms with a category from which on it can be known well, and up to which it is not known at all."""

HELPS = 0.95
"""Share of the error of plain places up to which learning has helped."""

READ_SO = (
    "Held-out rooms from above. Things were taken out (dashed: their true places), and each was asked for again: where "
    "its colour is strong, the model would put it. Not settled yet: <i>generate</i> moves things out of one another."
)
SHOWN = 5
STYLE = (
    "body{font:16px sans-serif;margin:2em auto;max-width:50em}td,th{padding:.2em 1em;text-align:right}"
    "td:first-child,th:first-child{text-align:left}.rooms{display:flex;flex-wrap:wrap;gap:1em}svg{max-width:100%}"
)


def knowledge(record: Mapping[str, Any]) -> str:
    """How well a category is known, "well", "hardly" or "not", by a record of :func:`~.training.category_records`."""
    if record["rooms"] < SEEN:
        return "not"
    helped = "plain" in record and record["taken"] <= HELPS * record["plain"]
    return "well" if record["rooms"] >= ENOUGH and helped else "hardly"


def report_lines(source: Mapping[str, Any], building: Sequence[str]) -> list[str]:
    """The page in plain lines, for the provenance of a model; what is ``building`` is left out."""
    records = [record for record in source["categories"] if record["category"] not in building]
    lines = [f"{source['scenes_trained']} rooms, {len(records)} categories of things"]
    for name in ("well", "hardly", "not"):
        mine = [record["category"] for record in records if knowledge(record) == name]
        more = first_lines(mine, SHOWN * 2, "more")
        lines.append(f"known {name}: {len(mine)}" + (f" ({', '.join(more)})" if mine else ""))
    for group in source["held_out"]:
        if group["objects"]:
            lines.append(
                f"{group['group']}: error {group['taken']:.2f} m, of plain places {group['plain']:.2f} m "
                f"({group['objects']} things of held-out rooms)"
            )
    return lines + advice(records)


def advice(records: Sequence[Mapping[str, Any]]) -> list[str]:
    """What to add, the commonest of what is in too few rooms first."""
    few = sorted((record for record in records if record["rooms"] < ENOUGH), key=lambda record: -record["objects"])
    return [f"add {ENOUGH - record['rooms']} more rooms with a {record['category']}" for record in few[:SHOWN]]


def write_report(source: Mapping[str, Any], building: Sequence[str], model: Path, pictures: Sequence[str] = ()) -> Path:
    """Write the page beside a model, with ``pictures`` (SVG) of held-out rooms; returns where."""
    path = model.with_suffix(SUFFIX)
    rows = "".join(_row(record) for record in source["categories"] if record["category"] not in building)
    told = "".join(f"<li>{escape(line)}</li>" for line in [*report_lines(source, building), *source["notes"]])
    head = "".join(f"<th>{name}</th>" for name in ("category", "known", "objects", "rooms", "plain, m", "model, m"))
    write_file(
        path,
        f"<!doctype html><meta charset='utf-8'><title>{escape(model.name)}</title><style>{STYLE}</style>"
        f"<h1>{escape(model.name)}</h1><ul>{told}</ul><table><tr>{head}</tr>{rows}</table>"
        "<p>Errors are energy scores of 32 draws, metres, on rooms that were held out: the mean distance to the true "
        "place less half the mean distance between draws. Plain places are copied from training rooms.</p>"
        f"{_shown(pictures)}\n",
    )
    return path


def _shown(pictures: Sequence[str]) -> str:
    if not pictures:
        return ""
    return f"<h2>Rooms that it has not seen</h2><p>{READ_SO}</p><div class='rooms'>{''.join(pictures)}</div>"


def _row(record: Mapping[str, Any]) -> str:
    cells = [record["category"], knowledge(record), record["objects"], record["rooms"]]
    cells += [record.get("plain", ""), record.get("taken", "")]
    return f"<tr>{''.join(f'<td>{escape(str(cell))}</td>' for cell in cells)}</tr>"
