"""``sceneState`` of SceneEval and SceneSmith: walls with holes, floors, and objects as models with a matrix.

Right-handed, z up, metres; the matrix, column by column, takes a model's own frame (y up, as in glTF) to the scene. How
large a model is, and what it is, stands with the model: ``<modelId>.glb`` and its ``data.json``, in the folder of
assets. 3dlg-hcvc/SceneEval, ``scenes/scene_state.py``; scene@1.0.2, arch@1.0.2.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...scene import SceneGraph
from ..axes import Y_UP, numbers
from ..layout_file import LayoutFile
from ..room_builder import RoomBuilder

NAME = "sceneState"
LICENCE = ""
KEY, FORMAT = "format", "sceneState"
DOORS = {"Door": "Door", "Window": "Window"}
ASSETS = ".assets"
"""Ends the name of the folder in which our own writer puts the models of a file."""


def recognises(data: Any) -> bool:
    """Whether it calls itself so."""
    return isinstance(data, dict) and data.get(KEY) == FORMAT


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The scene."""
    scene, builder = file.data["scene"], RoomBuilder(file.title)
    unit = float(scene.get("unit", 1.0) or 1.0)
    arch = scene.get("arch") or {}
    for element in arch.get("elements") or ():
        _element(builder, element, float(arch.get("scaleToMeters", 1.0) or 1.0), file)
    keys = {item.get("index"): str(item.get("id", item.get("index"))) for item in scene["object"]}
    for item in scene["object"]:
        _object(builder, item, unit, file)
        holder = item.get("parentId") or ""
        if holder in keys.values():
            builder.relate(str(item.get("id", item.get("index"))), "on_top_of", holder)
    yield builder.build()


def _element(builder: RoomBuilder, element: Mapping[str, Any], metre: float, file: LayoutFile) -> None:
    """A floor, a ceiling, or a wall with its doors and windows."""
    kind, uid = element["type"], str(element["id"])
    points = np.array([numbers((*point, 0.0)[:3], 3) for point in element["points"]]) * metre
    thick = float(element.get("depth") or 0.05) * metre
    if kind in ("Floor", "Ceiling"):
        others = {"room": str(element.get("roomId", ""))}
        builder.floor(points, kind, -thick if kind == "Floor" else thick, uid=uid, others=others)
    elif kind == "Wall":
        height = float(element["height"]) * metre
        frame = builder.wall(points[0], points[1], height, thick, uid=uid)
        for number, hole in enumerate(element.get("holes") or ()):
            (left, low), (right, high) = (numbers(hole["box"][end], 2) * metre for end in ("min", "max"))
            name = DOORS.get(hole["type"], hole["type"])
            key = str(hole.get("id") or f"{uid} hole {number}")
            builder.in_wall(name, frame, (left, right), (low, high), 1.5 * thick, uid=key)
    else:
        file.report.add(uid, f"an element of the kind {kind} is not read")


def _object(builder: RoomBuilder, item: Mapping[str, Any], unit: float, file: LayoutFile) -> None:
    """An object with its mesh, if that is there, in the model's frame turned to z up."""
    transform = item["transform"]
    matrix = numbers(transform["data"], 16).reshape(4, 4).T.copy()
    matrix[:3, 3] *= unit
    model = str(item.get("modelId", ""))
    uid, plain = str(item.get("id", item.get("index"))), model.rpartition(".")[2]
    mesh = file.assets.mesh(model, plain, f"{file.path.name.removesuffix('.json')}{ASSETS}/{model}/{model}")
    if mesh is None:
        file.report.add(model, "its model is not there: it is a place without a shape (--assets FOLDER)")
    said = _annotations(file, model)
    category = str(said.get("category", ""))
    builder.add(category, matrix @ Y_UP.T, mesh, uid=uid, others={"asset": model}, name=category or "Object")


def _annotations(file: LayoutFile, model: str) -> Mapping[str, Any]:
    """What a model's ``data.json`` says of it."""
    plain = model.rpartition(".")[2]
    for folder in (f"{file.path.name.removesuffix('.json')}{ASSETS}/{model}", model, plain):
        found = file.assets.at(f"{folder}/data.json")
        if found is not None:
            return json.loads(found.read_text("utf-8")).get("annotations") or {}
    return {}
