"""What a dataset is made of, and under which licences."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any


def source_counts(files: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Which kinds of file, under which licences, are in a dataset, with how many files and scenes; "" for unknown."""
    found: dict[tuple[str, str], list[int]] = {}
    for record in files:
        if record.get("scenes"):
            entry = found.setdefault((record.get("format", ""), record.get("licence", "")), [0, 0])
            entry[0], entry[1] = entry[0] + 1, entry[1] + record["scenes"]
    keys = ("format", "licence", "files", "scenes")
    return [dict(zip(keys, (*kind, *counts), strict=True)) for kind, counts in sorted(found.items())]
