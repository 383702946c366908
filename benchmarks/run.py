"""Runs the benchmarks that need no data, and says what has changed since the last run.

    python benchmarks/run.py [--quick] [--out build/benchmarks] [--only poses reading]

``changes.md`` lists every number that moved by more than a tenth; times move with whatever else the machine does.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from unisg_blender.experiments.reports import machine, markdown_table, write_json

HERE = Path(__file__).parent
UNISG = ("-m", "unisg_blender", "benchmark")
BENCHMARKS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "poses": ((*UNISG, "poses", "--out", "{out}", "--json", "-q"), ("--count", "20000", "--repeats", "3")),
    "motion": ((*UNISG, "motion", "--out", "{out}", "--json", "-q"), ()),
    "behaviour": ((f"{HERE}/behaviour.py", "--out", "{out}/behaviour.json"), ("--count", "1000", "--frames", "10")),
    "reading": ((f"{HERE}/reading.py", "--out", "{out}/reading.json"), ("--objects", "500", "--repeat", "3")),
    "pointing": ((f"{HERE}/pointing.py", "--out", "{out}/pointing.json"), ("--moves", "50")),
    "dataset": ((f"{HERE}/dataset.py", "million", "--out", "{out}/dataset.json"), ("--scenes", "10000")),
}
"""Words of each command, and what makes it quick; its report is ``NAME.json`` in the folder."""

MOVED = 0.1


def main() -> None:
    """Run, compare, keep for the next time."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("build/benchmarks"))
    parser.add_argument("--only", nargs="+", choices=BENCHMARKS, default=list(BENCHMARKS))
    parser.add_argument("--quick", action="store_true", help="small sizes, some minutes in all")
    args = parser.parse_args()
    kept = args.out / ("last-quick.json" if args.quick else "last.json")
    before = json.loads(kept.read_text("utf-8")) if kept.is_file() else {}
    found = {name: dict(numbers(report(name, args.out / name, args.quick))) for name in args.only}
    page = markdown_table(["number", "before", "now", "change"], changes(before, found))
    (args.out / "changes.md").write_text(page + "\n", encoding="utf-8")
    write_json(kept, {**before, **found, "machine": machine()})
    print(page)


def report(name: str, out: Path, quick: bool) -> Any:
    """What a benchmark measures."""
    words, fast = BENCHMARKS[name]
    out.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, *(word.format(out=out) for word in words), *(fast if quick else ())]
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
    return json.loads((out / f"{name}.json").read_text("utf-8"))


def numbers(record: Any, path: str = "") -> Iterator[tuple[str, float]]:
    """The numbers of a report by where they stand; rows of a table by their texts."""
    if isinstance(record, dict):
        for key, value in record.items():
            if key not in ("machine", "settings", "load_average"):
                yield from numbers(value, f"{path}/{key}")
    elif isinstance(record, list):
        for place, row in enumerate(record):
            texts = [value for value in row.values() if isinstance(value, str)] if isinstance(row, dict) else []
            yield from numbers(row, f"{path}/{', '.join(texts) or place}")
    elif isinstance(record, int | float) and not isinstance(record, bool):
        yield path, float(record)


def changes(before: dict[str, Any], found: dict[str, dict[str, float]]) -> list[list[str]]:
    """Rows of the numbers that moved by more than :data:`MOVED`, and of those that are new."""
    rows = []
    for name, values in found.items():
        for path, value in values.items():
            old = before.get(name, {}).get(path)
            if old is None:
                rows.append([f"{name}{path}", "", f"{value:.4g}", "new"])
            elif abs(value - old) > MOVED * abs(old):
                rows.append([f"{name}{path}", f"{old:.4g}", f"{value:.4g}", f"{value / old - 1:+.0%}" if old else ""])
    return rows


if __name__ == "__main__":
    main()
