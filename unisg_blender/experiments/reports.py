"""What every report of measurements is made of: a JSON file, CSV files, and what it was measured on."""

from __future__ import annotations

import csv
import json
import os
import platform
import shlex
import sys
from collections.abc import Iterable, Mapping, Sequence
from datetime import date
from importlib import metadata
from pathlib import Path
from typing import Any

from ..errors import UniSGError
from ..runtime.atomic_files import write_file

PACKAGES = ("numpy", "scipy", "clifford", "torch")

Table = list[dict[str, Any]]


def write_json(path: Path, record: Mapping[str, Any]) -> None:
    """Write a report for people and programs."""
    path.write_text(json.dumps(record, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def write_results(path: Path, found: Mapping[str, Any]) -> None:
    """Write a file of results: what was found, and how, :func:`made_by`."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_json(path, made_by() | dict(found))


def write_csv(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write rows under the union of their keys, in the order in which these first appear."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)


def claim_folder(folder: Path, quick: bool) -> None:
    """Results of one size stand in a folder; UniSGError where it holds those of the other, which must not be mixed."""
    path = folder / "settings.json"
    if path.is_file() and json.loads(path.read_text("utf-8"))["quick"] != quick:
        raise UniSGError(f"{folder} holds results made {'without' if quick else 'with'} --quick: choose another folder")
    write_file(path, json.dumps({"quick": quick}))


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown; the columns behind the first are for numbers."""
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def made_by() -> dict[str, Any]:
    """What a file of results begins with: the command that makes it, when that was, and on what machine.

    Of paths that begin at the root only the name is told: where they lie is no matter of the command.
    """
    program = Path(sys.argv[0]).absolute()
    root = next((folder for folder in program.parents if (folder / "pyproject.toml").is_file()), program.parent.parent)
    script = ["python", program.relative_to(root).as_posix()]
    name = ["unisg"] if program.name == "__main__.py" else script if program.suffix == ".py" else [program.name]
    words = [Path(word).name if word.startswith("/") else word for word in sys.argv[1:]]
    return {"command": shlex.join([*name, *words]), "date": date.today().isoformat(), "machine": machine()}


def machine() -> dict[str, Any]:
    """What the numbers were measured on."""
    return {
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        "processors": os.cpu_count(),
        **{package: _version(package) for package in PACKAGES},
    }


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None
