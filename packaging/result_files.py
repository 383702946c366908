"""The files of docs/results/ as tables, for the pages that cite them."""

from __future__ import annotations

import ast
import csv
import json
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import onnx

ROOT = Path(__file__).resolve().parents[1]
RESULTS, LIBRARY = ROOT / "docs" / "results", ROOT / "unisg_blender"
MARKED = ROOT / "benchmarks" / "interiors" / "interiors.json"
NUMBER = re.compile(r"(?<![\w.,])[-−]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?(?!\w|[.,]\d)")


class Table:
    """Rows of a file: ``table("cm_median", "target, base case", form="sixd")`` is one cell, ``all`` a list of them."""

    def __init__(self, rows: Sequence[Mapping[str, Any]]) -> None:
        self.rows = rows

    def all(self, column: str, *first: Any, **where: Any) -> list[Any]:
        """The cells of a column in rows whose first columns have these values, others those (one, or a tuple)."""
        cells = [row.get(column) for row in self.where(**dict(zip(self.rows[0], first, strict=False)) | where).rows]
        return [cell for cell in cells if cell is not None]

    def where(self, **where: Any) -> Table:
        """The rows with these values (one, or a tuple of them) in some columns."""
        wanted = {name: value if isinstance(value, tuple) else (value,) for name, value in where.items()}
        return Table([row for row in self.rows if all(row[name] in among for name, among in wanted.items())])

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
    records = {path.stem: path for path in sorted(RESULTS.glob("*.json"))} | {"marked_interiors": MARKED}
    for name, path in records.items():
        found[name] = json.loads(path.read_text("utf-8"), object_hook=_with_tables)
    for path in (*sorted(RESULTS.glob("*.csv")), LIBRARY / "pretrained" / "atlasnet_models.csv"):
        with path.open(encoding="utf-8", newline="") as file:
            rows = [{name: parsed(cell) for name, cell in row.items()} for row in csv.DictReader(file)]
        found[f"{path.stem}_csv" if path.stem in found else path.stem] = Table(rows)
    return found


def _with_tables(record: dict[str, Any]) -> dict[str, Any]:
    """Lists of rows as tables."""
    tables = {key: Table(value) for key, value in record.items() if isinstance(value, list) and value}
    return record | {key: table for key, table in tables.items() if isinstance(table.rows[0], Mapping)}


@cache
def constants(module: str) -> dict[str, Any]:
    """What a module of the library sets to literals, fields of classes with the name of the class; not imported."""
    tree = ast.parse((LIBRARY / f"{module.replace('.', '/')}.py").read_text("utf-8"))
    bodies = [("", tree.body), *((f"{node.name}.", node.body) for node in tree.body if isinstance(node, ast.ClassDef))]
    assigned = [
        (prefix, node) for prefix, body in bodies for node in body if isinstance(node, ast.Assign | ast.AnnAssign)
    ]
    found: dict[str, Any] = {}
    for prefix, node in assigned:
        target, value = node.targets[0] if isinstance(node, ast.Assign) else node.target, node.value
        several = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
        for name, one in zip(target.elts, value.elts, strict=True) if several else [(target, value)]:
            with suppress(ValueError):  # no literal
                found[f"{prefix}{ast.unparse(name)}"] = ast.literal_eval(one)
    return found


def constant(name: str) -> Any:
    """A constant of the library, ``constant("generate.propose.anchor_proposer:DRAWN")``: imported if no literal."""
    module, _, wanted = name.partition(":")
    known = constants(module) if (LIBRARY / f"{module.replace('.', '/')}.py").is_file() else {}
    return known[wanted] if wanted in known else getattr(import_module(f"unisg_blender.{module}"), wanted)


@cache
def model(name: str) -> dict[str, Any]:
    """What the file of a shipped model says of itself, how it was trained under ``provenance``."""
    file = onnx.load(LIBRARY / "pretrained" / f"{name}.onnx")
    return json.loads(next(entry.value for entry in file.metadata_props if entry.key == "unisg"))


def megabytes(name: str) -> float:
    """The size of a shipped file."""
    return (LIBRARY / "pretrained" / name).stat().st_size / 1e6
