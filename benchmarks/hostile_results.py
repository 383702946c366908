"""What came of hostile inputs, a row for each kind, in one file of results."""

from __future__ import annotations

import csv
from pathlib import Path

COLUMNS = ("kind", "inputs", "read", "refused", "by_guard", "unforeseen", "faults", "seed")
"""``refused`` holds ``by_guard`` (a library crashed or hung, the command line told it) and ``unforeseen`` (some part of
the reading stumbled, which was told in one line); ``faults`` is everything that was not answered in one line."""


def keep(path: Path, row: dict[str, str | int]) -> None:
    """Put a row into the file, in place of the one of the same kind."""
    rows = {str(row["kind"]): row}
    if path.exists():
        with path.open(newline="", encoding="utf-8") as file:
            rows = {each["kind"]: each for each in csv.DictReader(file)} | rows
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, restval=0, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows[kind] for kind in sorted(rows))
