"""Folders of mesh files as models: what each one is, how big it is, and on which side of the split it stands."""

from __future__ import annotations

import csv
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..pretrained import FOLDER
from ..scene.mesh import Mesh
from .mesh_files import Y_UP_TO_Z_UP, mesh_paths, read_mesh_file

TABLE = FOLDER / "atlasnet_models.csv"
"""Name, category, split, real size, author and licence of the models that the shipped networks come from."""

SPLITS = ("train", "test", "unseen", "known", "trust")


@dataclass(frozen=True, eq=False)
class ShapeFile:
    """One mesh with what is known of it.

    ``split`` is "train", "test" (a held-out model of a category that is trained
    on) or "unseen" (its whole category is held out). Only the model of categories
    takes more: "known" shapes, and by those of "trust" it is told how often it is
    right. Models of one ``family`` are variants of each other; those read from files
    are always in one split.
    """

    name: str
    category: str
    split: str
    family: str
    mesh: Mesh


def read_models(folders: Sequence[str | Path], table: str | Path = TABLE) -> list[ShapeFile]:
    """All mesh files under some folders, in the order of their paths, in metres, Z up.

    A file that the table names (by its path's last parts) has its name, category,
    split and size from there. Any other file is named after itself, has the
    category of the folder it lies in and keeps its size; one in five of them, by
    a checksum of the name, is in split "test".

    Raises
    ------
    UniSGError
        If a folder does not exist or has no mesh files, or a file is damaged.
    """
    rows = _read_table(table)
    return [_model(path, folder, rows) for folder in map(Path, folders) for path in mesh_paths(folder)]


def _read_table(table: str | Path) -> dict[str, dict[str, str]]:
    with open(table, newline="", encoding="utf-8") as text:
        return {row["file"]: row for row in csv.DictReader(text)}


def _model(path: Path, folder: Path, rows: dict[str, dict[str, str]]) -> ShapeFile:
    mesh = read_mesh_file(path)
    parts = path.as_posix().split("/")
    row = next((rows[key] for k in range(len(parts)) if (key := "/".join(parts[k:])) in rows), None)
    if row is None:
        category = path.parent.name if path.parent != folder else ""
        held_out = zlib.crc32(path.stem.encode()) % 5 == 0
        return ShapeFile(path.stem, category, "test" if held_out else "train", path.stem, mesh)
    return ShapeFile(row["name"], row["category"], row["split"], row["family"], _sized(mesh, row))


def _sized(mesh: Mesh, row: dict[str, str]) -> Mesh:
    """The mesh turned as the table says (a 3x3 matrix in the file's Y-up frame) and scaled to its real size."""
    points = mesh.points.astype(np.float64)
    if row["rotation"]:
        turn = np.array(row["rotation"].split(), float).reshape(3, 3)
        points = points @ (Y_UP_TO_Z_UP @ turn @ Y_UP_TO_Z_UP.T).T
    size = np.array([float(row[side]) for side in ("width", "depth", "height")])
    extent = np.ptp(points, axis=0)
    points = (points - points.min(axis=0)) * (size / np.maximum(extent, 1e-12))
    return replace(mesh, name=row["name"], points=points.astype(np.float32))


def of_split(models: Iterable[ShapeFile], split: str) -> list[ShapeFile]:
    """The models of one split."""
    return [model for model in models if model.split == split]
