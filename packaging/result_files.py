"""The files of docs/results/ as tables, for the pages that cite them."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).resolve().parents[1] / "docs" / "results"
NUMBER = re.compile(r"(?<![\w.,])[-−]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?(?!\w|[.,]\d)")


class Table:
    """Rows of a file: ``table("cm_median", "target, base case", form="sixd")`` is one cell, ``all`` a list of them."""

    def __init__(self, rows: Sequence[Mapping[str, Any]]) -> None:
        self.rows = rows

    def all(self, column: str, *first: Any, **where: Any) -> list[Any]:
        """The cells of a column in rows whose first columns have these values, others those (one, or a tuple)."""
        wanted = dict(zip(self.rows[0], first, strict=False)) | where
        allowed = {name: value if isinstance(value, tuple) else (value,) for name, value in wanted.items()}
        cells = [row.get(column) for row in self.rows if all(row[name] in among for name, among in allowed.items())]
        return [cell for cell in cells if cell is not None]

    def __call__(self, column: str, *first: Any, **where: Any) -> Any:
        """The only such cell."""
        found = self.all(column, *first, **where)
        if len(found) != 1:
            raise ValueError(f"{len(found)} cells of {column!r} for {first} {where}")
        return found[0]


def parsed(cell: str) -> Any:
    """A CSV cell as a number where it is one; None if empty."""
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell or None


@cache
def results() -> dict[str, Any]:
    """What the files of docs/results/ hold, by their names without ending."""
    found: dict[str, Any] = {}
    for path in sorted(RESULTS.glob("*.json")):
        found[path.stem] = json.loads(path.read_text("utf-8"), object_hook=_with_tables)
    for path in sorted(RESULTS.glob("*.csv")):
        with path.open(encoding="utf-8", newline="") as file:
            rows = [{name: parsed(cell) for name, cell in row.items()} for row in csv.DictReader(file)]
        found[f"{path.stem}_csv" if path.stem in found else path.stem] = Table(rows)
    return found


def _with_tables(record: dict[str, Any]) -> dict[str, Any]:
    """Lists of rows as tables."""
    tables = {key: Table(value) for key, value in record.items() if isinstance(value, list) and value}
    return record | {key: table for key, table in tables.items() if isinstance(table.rows[0], Mapping)}


def by_hand(key: str, place: int) -> float:
    """One number of an entry of ``by_hand.json``."""
    return float(results()["by_hand"][key]["numbers"][place].replace(",", "").replace("−", "-"))


def in_files(names: Sequence[str]) -> set[float]:
    """All numbers in some files, those in words too."""
    known: set[float] = set()
    left = [results()[name] for name in names]
    while left:
        value = left.pop()
        if isinstance(value, Table):
            left += value.rows
        elif isinstance(value, Mapping):
            left += [*value.keys(), *value.values()]
        elif isinstance(value, list):
            left += value
        elif isinstance(value, str):
            known |= {float(match.group().replace(",", "").replace("−", "-")) for match in NUMBER.finditer(value)}
        elif isinstance(value, int | float):
            known.add(float(value))
    return known
