"""A scene as ``sceneState`` of SceneEval: a JSON file, and beside it a folder with a .glb for each object.

Floors, ceilings, walls, doors and windows are those that categories name; a wall is the line through the middle of its
box. Every other object is a model with all parts that are no objects themselves; what it stands on is ``parentId``.
``data.json`` beside a model has its category, where SceneEval's class for the assets of LayoutVLM looks for it.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from ..runtime.atomic_files import replacing
from ..runtime.made_files import filling
from ..runtime.read_report import ReadReport
from ..scene import SceneGraph
from .axes import Y_UP, Array
from .layouts.scene_states import ASSETS, FORMAT, KEY
from .mesh_parts import joined_mesh

BUILDING = ("Floor", "Ceiling", "Wall", "Door", "Window")
HOLDS = ("on_top_of", "inside", "hangs_from")
NEAR = 0.15
"""Metres from the middle of a wall's sheet, beyond half its thickness, in which a door or a window is still in it."""

LEFT_OUT = ("actions", "lsa", "animation", "camera", "light", "joints", "instances")


def write_scene_state(graph: SceneGraph, path: Path) -> ReadReport:
    """Write a scene; returns what the format cannot hold. UniSGError if the files cannot be written."""
    report, owner = ReadReport(), _owners(graph)
    elements = _elements(graph, report)
    stem = path.name.removesuffix(".json")
    objects = [row for row in range(len(graph)) if owner[row] == row and graph.category_name(row) not in BUILDING]
    number = {row: str(place + 1) for place, row in enumerate(objects)}
    holders = {}
    for row, kind, uid in graph.entries("relations", "kind", "target"):
        if kind in HOLDS and uid in graph.row_of_uid:
            holders[row] = int(owner[graph.row_of_uid[uid]])
    records = []
    with replacing(path) as unfinished, filling(path.with_name(stem + ASSETS)) as models:
        for row in objects:
            model = f"unisg-{int(number[row]):04d}"
            if not _write_model(graph, row, np.flatnonzero(owner == row), models / model):
                report.add(graph.name[row], "it has no geometry: it is left out")
                continue
            data = (graph.world[row] @ Y_UP).T.ravel().tolist()
            record = {"id": number[row], "index": int(number[row]) - 1, "modelId": model}
            record |= {"parentId": number.get(holders.get(row, -1), ""), "parentIndex": -1}
            records.append(record | {"transform": {"rows": 4, "cols": 4, "data": data}})
        whole = {KEY: FORMAT, "scene": _scene(graph, elements, records), "selected": []}
        unfinished.write_text(json.dumps(whole), "utf-8")
    for name in LEFT_OUT:
        if name in graph.components:
            report.add("", f"{name} are not part of a sceneState")
    return report


def _scene(graph: SceneGraph, elements: list[dict[str, Any]], objects: list[dict[str, Any]]) -> dict[str, Any]:
    frame: dict[str, Any] = {"up": [0, 0, 1], "front": [0, 1, 0]}
    walls = [each["id"] for each in elements if each["type"] == "Wall"]
    arch = {"version": "arch@1.0.2", "id": f"{graph.title} building", **frame, "coords2d": [0, 1], "scaleToMeters": 1.0}
    arch |= {"elements": elements, "regions": [{"id": "0", "type": "Other", "walls": walls}]}
    scene = {"version": "scene@1.0.2", "id": graph.title, **frame, "unit": 1.0, "assetSource": ["unisg"]}
    return scene | {"arch": arch, "object": objects}


def _owners(graph: SceneGraph) -> Any:
    """int (N,): the row of the object that each row is a part of, -1 for none: with a category, or a mesh."""
    owner = np.full(len(graph), -1)
    for row in range(len(graph)):
        above = owner[graph.parent[row]] if graph.parent[row] >= 0 else -1
        own = graph.category[row] >= 0 or (above < 0 and graph.mesh[row] >= 0)
        owner[row] = row if own else above
    return owner


def _write_model(graph: SceneGraph, row: int, parts: Any, folder: Path) -> bool:
    """Write the meshes of an object in its own frame, y up; whether there are any."""
    import trimesh

    back = np.linalg.pinv(graph.world[row])
    placed = [(back @ graph.world[part], graph.meshes[graph.mesh[part]]) for part in parts if graph.mesh[part] >= 0]
    mesh = joined_mesh(graph.name[row], placed)
    if not len(mesh.points) or not len(mesh.triangles):
        return False
    folder.mkdir()
    points = mesh.points.astype(np.float64) @ Y_UP[:3, :3]
    scene = trimesh.Scene(trimesh.Trimesh(points, mesh.triangles, process=False))
    (folder / f"{folder.name}.glb").write_bytes(scene.export(file_type="glb"))
    category = graph.category_name(row) or graph.name[row]
    said = {"category": category, "description": category.lower(), "materials": []}
    (folder / "data.json").write_text(json.dumps({"annotations": said}), "utf-8")
    return True


def _elements(graph: SceneGraph, report: ReadReport) -> list[dict[str, Any]]:
    """The building: floors and ceilings with outlines, walls with their holes."""
    rows = {name: [row for row in range(len(graph)) if graph.category_name(row) == name] for name in BUILDING}
    found, walls = [], []
    for row in rows["Wall"]:
        if graph.mesh[row] >= 0:
            start, along, length, height, thick = _wall(graph, row)
            points = [start.tolist(), (start + along * length).tolist()]
            element = {"id": f"wall|{row}", "type": "Wall", "roomId": "0", "height": height, "depth": thick}
            walls.append((start, along, length, thick, element | {"points": points, "holes": []}))
    for kind in ("Floor", "Ceiling"):
        for row in rows[kind]:
            if graph.mesh[row] >= 0:
                outline = _outline(graph, row, kind == "Ceiling").tolist()
                found.append(
                    {"id": f"{kind.lower()}|{row}", "type": kind, "roomId": "0", "depth": 0.05, "points": outline}
                )
    for row in [*rows["Door"], *rows["Window"]]:
        if not _add_hole(graph, row, walls):
            report.add(graph.name[row], "it is in no wall: it is left out")
    return [*found, *(element for *_, element in walls)]


def _corners(graph: SceneGraph, row: int) -> Array:
    """World corners (2, 2, 2, 3) of the box of an entity's mesh."""
    low, high = graph.meshes[graph.mesh[row]].bounds
    ends = np.array([[[[x, y, z] for z in (low[2], high[2])] for y in (low[1], high[1])] for x in (low[0], high[0])])
    return np.asarray(ends @ graph.world[row, :3, :3].T + graph.world[row, :3, 3])


def _wall(graph: SceneGraph, row: int) -> tuple[Array, Array, float, float, float]:
    """Start on the ground, direction, length, height and thickness of a wall, by its box."""
    corners = _corners(graph, row)
    edges = np.array([corners[1, 0, 0], corners[0, 1, 0], corners[0, 0, 1]]) - corners[0, 0, 0]
    flat = np.linalg.norm(edges[:, :2], axis=1)
    first, second = np.argsort(-flat)[:2]
    along = np.append(edges[first, :2] / max(flat[first], 1e-9), 0.0)
    middle = corners.reshape(-1, 3).mean(axis=0)
    start = middle - along * flat[first] / 2
    start[2] = corners[..., 2].min()
    return start, along, float(flat[first]), float(np.ptp(corners[..., 2])), float(flat[second])


def _outline(graph: SceneGraph, row: int, lower: bool) -> Array:
    """The outline (K, 3) of a slab: its one face that is on top (of a ceiling: below), else its box's."""
    mesh = graph.meshes[graph.mesh[row]]
    points = mesh.points @ graph.world[row, :3, :3].T + graph.world[row, :3, 3]
    height = points[:, 2].min() if lower else points[:, 2].max()
    faces = [mesh.corners[a:b] for a, b in zip(mesh.offsets[:-1], mesh.offsets[1:], strict=True)]
    level = [face for face in faces if len(face) > 2 and np.abs(points[face, 2] - height).max() < 1e-3]
    if len(level) == 1:
        return np.asarray(points[level[0]], np.float64)
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array(
        [[x, y, height] for x, y in ((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]))]
    )


def _add_hole(graph: SceneGraph, row: int, walls: list[tuple[Array, Array, float, float, dict[str, Any]]]) -> bool:
    """Make a door or a window a hole of the wall that it is in."""
    if graph.mesh[row] < 0:
        return False
    corners = _corners(graph, row).reshape(-1, 3)
    middle = corners.mean(axis=0)
    for start, along, length, thick, element in walls:
        across = np.array([-along[1], along[0], 0.0])
        place = float((middle - start) @ along)
        if abs(float((middle - start) @ across)) > thick / 2 + NEAR or not 0 < place < length:
            continue
        reach = np.clip((corners - start) @ along, 0, length)
        up = np.clip(corners[:, 2] - start[2], 0, element["height"])
        box = {"min": [float(reach.min()), float(up.min())], "max": [float(reach.max()), float(up.max())]}
        element["holes"].append({"id": f"hole|{row}", "type": graph.category_name(row), "box": box})
        return True
    return False
