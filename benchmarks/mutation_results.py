"""Which random changes of an operator were noticed, a row for each, in one file of results."""

from __future__ import annotations

import csv
from pathlib import Path

COLUMNS = ("seed", "number", "room", "line", "old", "new", "noticed", "why")
"""``noticed`` is "tests", "more tests" (which alone did) or "no"; somebody who has read the line may say
"no difference" there, and ``why``."""

Row = dict[str, str]


def kept(path: Path | None, seed: int) -> dict[int, Row]:
    """What earlier calls with this seed found, by the number of the change."""
    return {int(row["number"]): row for row in _rows(path) if int(row["seed"]) == seed}


def keep(path: Path, row: Row) -> None:
    """Put a row into the file, in place of one of the same change."""
    rows = {(int(each["seed"]), int(each["number"])): each for each in [*_rows(path), row]}
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows[key] for key in sorted(rows))


def _rows(path: Path | None) -> list[Row]:
    if path is None or not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))
