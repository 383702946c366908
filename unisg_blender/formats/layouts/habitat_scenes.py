"""Scenes of Habitat (``*.scene_instance.json``; HSSD, ReplicaCAD): a stage and objects, placed as templates.

Right-handed, y up, metres; quaternions are w x y z. A template is an ``.object_config.json`` or ``.stage_config.json``
in the data set's folder (where the ``.scene_dataset_config.json`` is), which names the mesh and its frame; categories
are in ``semantics/objects.csv``. A translation is that of the asset's own origin ("asset_local"), or of its centre of
mass: the one that its template names, else the middle of its box. What stands on what is not told.
https://aihabitat.org/docs/habitat-sim/attributesJSON.html
"""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import UniSGError
from ...scene import Mesh, SceneGraph
from ..axes import Y_UP, Array, numbers, pose, quaternion_turn, seen_from
from ..layout_file import LayoutFile
from ..mesh_parts import KINDS, mesh_parts, moved, whole_mesh
from ..room_builder import RoomBuilder

NAME = "Habitat scene"
LICENCE = ""
DATASET = ".scene_dataset_config.json"
CONFIGS = (".object_config.json", ".stage_config.json", ".ao_config.json")
KINDS_MADE = ("stages", "objects", "articulated_objects")
CATEGORY_FILES = ("semantics/objects.csv", "metadata/object_categories_filtered.csv", "metadata/objects.csv")
CATEGORIES = ("main_category", "clean_category", "category", "super_category")
LEVELS = 4


def recognises(data: Any) -> bool:
    """Whether it places objects, or a stage, by templates."""
    placed = data.get("object_instances") if isinstance(data, dict) else None
    if isinstance(placed, list) and placed:
        return "template_name" in placed[0]
    return isinstance(data, dict) and "template_name" in (data.get("stage_instance") or {})


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The scene."""
    root, builder = _dataset(file), RoomBuilder(file.title)
    templates, categories = _templates(root), _categories(root)
    default = str(file.data.get("translation_origin", "default")).lower()
    stage = file.data.get("stage_instance")
    if stage:
        _stage(file, builder, stage, templates)
    placed = [*(file.data.get("object_instances") or ()), *(file.data.get("articulated_object_instances") or ())]
    for number, item in enumerate(placed):
        _object(file, builder, item, templates, categories, default)
        file.tell(number + 1, len(placed))
    file.report.add("", "what stands on what is not told")
    yield builder.build()


def _dataset(file: LayoutFile) -> Path:
    """The folder of the data set: the user's, or the nearest with its description, else the one above the file's."""
    if file.assets.named is not None:
        return file.assets.named
    folder = file.path.absolute().parent
    for place in [folder, *folder.parents][:LEVELS]:
        if any(place.glob("*" + DATASET)):
            return place
    return folder.parent


class _Templates:
    """The templates of a data set, by their names without ending: files of their own, and those that its description
    makes, of which each has a file that it changes, if any, and what it says."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.files: dict[str, Path] = {}
        self.made: dict[str, tuple[str, Mapping[str, Any]]] = {}
        for folder, folders, names in os.walk(root):
            folders[:] = sorted(name for name in folders if not name.startswith("."))
            for name in sorted(names):
                if ending := next((each for each in CONFIGS if name.endswith(each)), ""):
                    self.files.setdefault(name.removesuffix(ending), Path(folder, name))
        for file in sorted(root.glob("*" + DATASET)):
            data = json.loads(file.read_text("utf-8"))
            for item in (item for kind in KINDS_MADE for item in (data.get(kind) or {}).get("configs") or ()):
                if name := str(item.get("template_handle") or ""):
                    self.made[name] = str(item.get("original_file") or ""), item.get("attributes") or {}

    def find(self, name: str) -> tuple[Mapping[str, Any], Path | None]:
        """What a template says, and the file of its mesh, if that is there."""
        short = name.rpartition("/")[2]
        original, changes = self.made.get(short, ("", {}))
        config = self.root / original if original else self.files.get(short)
        said = json.loads(config.read_text("utf-8")) if config is not None and config.is_file() else {}
        folder = self.root if config is None or "render_asset" in changes else config.parent
        said = {**said, **changes}
        mesh = folder / said["render_asset"] if said.get("render_asset") else None
        return said, mesh if mesh is not None and mesh.is_file() and mesh.suffix.lower() in KINDS else None


@lru_cache(maxsize=8)
def _templates(root: Path) -> _Templates:
    return _Templates(root)


@lru_cache(maxsize=8)
def _categories(root: Path) -> dict[str, str]:
    """Categories by template, from the first table that is there."""
    for name in CATEGORY_FILES:
        if (root / name).is_file():
            with (root / name).open(encoding="utf-8", newline="") as lines:
                rows = csv.DictReader(lines)
                column = next((each for each in CATEGORIES if each in (rows.fieldnames or ())), None)
                return {} if column is None else {row.get("id") or "": row.get(column) or "" for row in rows}
    return {}


def _placed(item: Mapping[str, Any]) -> Array:
    """The matrix of an instance in Habitat's frame."""
    turn = quaternion_turn(*numbers(item["rotation"], 4)) if item.get("rotation") else np.eye(3)
    scale = numbers(item.get("non_uniform_scale") or (1.0, 1.0, 1.0), 3) * float(item.get("uniform_scale", 1.0))
    return pose(item.get("translation") or (0.0, 0.0, 0.0), turn, scale)


def _frame(said: Mapping[str, Any]) -> Array:
    """From an asset's own frame to Habitat's: its up becomes y, its front -z, with the template's scale."""
    up = numbers(said.get("up") or (0, 1, 0), 3)
    front = numbers(said.get("front") or (0, 0, -1), 3)
    turn = np.stack([np.cross(front, up), up, -front])
    if abs(np.linalg.det(turn) - 1) > 1e-3:
        raise ValueError("a template's up and front are not at a right angle")
    return np.diag([*numbers(said.get("scale") or (1, 1, 1), 3), 1.0]) @ pose((0, 0, 0), turn)


def _stage(file: LayoutFile, builder: RoomBuilder, item: Mapping[str, Any], templates: _Templates) -> None:
    """The building, an entity for each part of its mesh."""
    said, path = templates.find(str(item["template_name"]))
    if path is None:
        file.report.add(str(item["template_name"]), "the stage is not there: floor and walls are left out")
        return
    matrix = Y_UP @ _placed(item) @ _frame(said)
    number = builder.add("", np.eye(4), name=str(item["template_name"]).rpartition("/")[2])
    for name, local, mesh in mesh_parts(path, upright=False):
        builder.add("", matrix @ local, mesh, name=name, parent=number)


def _object(
    file: LayoutFile, builder: RoomBuilder, item: Mapping[str, Any], templates: _Templates,
    categories: Mapping[str, str], default: str,
) -> None:  # fmt: skip
    """An object with its mesh, if that is there, in its own frame turned to z up."""
    name = str(item["template_name"])
    short = name.rpartition("/")[2]
    said, path = templates.find(name)
    matrix, mesh = _placed(item), _shape(path, said, file, short)
    origin = str(item.get("translation_origin", default)).lower()
    if mesh is not None and origin != "asset_local":
        middle = mesh.bounds.mean(axis=0) @ Y_UP[:3, :3]
        matrix = matrix @ pose(-(numbers(said["COM"], 3) if "COM" in said else middle))
    category = categories.get(short, "")
    builder.add(category, seen_from(Y_UP, matrix), mesh, name=category or short, others={"asset": short})


def _shape(path: Path | None, said: Mapping[str, Any], file: LayoutFile, name: str) -> Mesh | None:
    """The mesh of a template in our frame."""
    if path is None:
        file.report.add(name, "its mesh is not there: it is a place without a shape (--assets FOLDER of the data set)")
        return None
    try:
        return moved(whole_mesh(path, False), Y_UP @ _frame(said))
    except UniSGError:
        file.report.add(name, "its mesh cannot be read: it is a place without a shape")
        return None
