"""The data of new objects: meshes, cameras, lights, armatures and the rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import bpy
import numpy as np

from ..scene.components import CAMERA, EMPTY, MATERIALS
from ..scene.graph import TYPES, SceneGraph
from .read_data import BLENDER_NAME, CAMERA_NUMBERS, LIGHT_NUMBERS
from .report import ReadReport
from .write_meshes import write_mesh

Made = dict[object, bpy.types.ID | None]


def object_data(
    graph: SceneGraph, row: int, made: Made, materials: Mapping[str, bpy.types.Material], report: ReadReport
) -> bpy.types.ID | None:
    """The data-block of one row, shared with the rows that share it; None for empties.

    ``made`` collects what was made so far.
    """
    kind, mesh = TYPES[graph.type[row]], int(graph.mesh[row])
    if mesh >= 0:
        if kind != "MESH":
            report.add(graph.name[row], f"is a mesh in Blender, no longer of type {kind.lower()}")
        if ("mesh", mesh) not in made:
            made["mesh", mesh] = write_mesh(graph.meshes[mesh], materials)
        return made["mesh", mesh]
    if kind in ("EMPTY", "OTHER"):
        return None
    entry = _entry(graph, kind.lower(), row)
    key = (kind, entry.get("data", (kind, row)))
    if key not in made:
        name = str(entry.get("data", graph.name[row]))
        made[key] = _MAKERS.get(kind, _nothing)(name)
        if kind == "CAMERA":
            _set_camera(made[key], entry)
        elif kind == "LIGHT":
            made[key] = _light(name, entry)
    return made[key]


def _entry(graph: SceneGraph, component: str, row: int) -> dict[str, Any]:
    found = graph.components.get(component)
    if found is None:
        return {}
    columns = found.of(row)
    return {name: column[0] for name, column in columns.items() if len(column)}


def _grease_pencil(name: str) -> bpy.types.ID:
    shelf = getattr(bpy.data, "grease_pencils_v3", None) or bpy.data.grease_pencils  # one name again from 5.0 on
    return shelf.new(name)


def _nothing(name: str) -> None:
    return None


_MAKERS: dict[str, Callable[[str], bpy.types.ID | None]] = {
    "MESH": lambda name: bpy.data.meshes.new(name),
    "CAMERA": lambda name: bpy.data.cameras.new(name),
    "ARMATURE": lambda name: bpy.data.armatures.new(name),
    "CURVE": lambda name: bpy.data.curves.new(name, "CURVE"),
    "SURFACE": lambda name: bpy.data.curves.new(name, "SURFACE"),
    "FONT": lambda name: bpy.data.curves.new(name, "FONT"),
    "META": lambda name: bpy.data.metaballs.new(name),
    "CURVES": lambda name: bpy.data.hair_curves.new(name),
    "LATTICE": lambda name: bpy.data.lattices.new(name),
    "POINTCLOUD": lambda name: bpy.data.pointclouds.new(name),
    "VOLUME": lambda name: bpy.data.volumes.new(name),
    "SPEAKER": lambda name: bpy.data.speakers.new(name),
    "LIGHT_PROBE": lambda name: bpy.data.lightprobes.new(name, "SPHERE"),
    "GREASEPENCIL": _grease_pencil,
}


def _set_camera(camera: bpy.types.Camera, entry: Mapping[str, Any]) -> None:
    if not entry:
        return
    camera.type, camera.sensor_fit = str(entry["kind"]), str(entry["fit"])
    for name in CAMERA_NUMBERS:
        setattr(camera, name, float(entry[name]))


def _light(name: str, entry: Mapping[str, Any]) -> bpy.types.Light:
    light = bpy.data.lights.new(name, str(entry.get("kind", "POINT")))
    if not entry:
        return light
    light.color = tuple(entry["color"])
    if entry["shape"]:
        light.shape = str(entry["shape"])
    for key in LIGHT_NUMBERS:
        if hasattr(light, BLENDER_NAME.get(key, key)):
            setattr(light, BLENDER_NAME.get(key, key), float(entry[key]))
    return light


def set_empties(graph: SceneGraph, objects: Mapping[int, bpy.types.Object]) -> None:
    """How empties are drawn."""
    found = graph.components.get(EMPTY)
    if found is None:
        return
    for row, item in objects.items():
        entry = found.of(row)
        if item.data is None and len(entry["size"]):
            item.empty_display_type, item.empty_display_size = str(entry["display"][0]), float(entry["size"][0])


def set_materials(
    graph: SceneGraph, objects: Mapping[int, bpy.types.Object], materials: Mapping[str, bpy.types.Material]
) -> None:
    """Materials that belong to the object and not to its mesh."""
    found = graph.components.get(MATERIALS)
    if found is None:
        return
    for row, slot, name in zip(found.rows, found.columns["slot"], found.columns["material"], strict=True):
        item = objects.get(int(row))
        if item is not None and slot < len(item.material_slots):
            item.material_slots[int(slot)].link = "OBJECT"
            item.material_slots[int(slot)].material = materials.get(str(name))


def set_active_camera(graph: SceneGraph, objects: Mapping[int, bpy.types.Object], scene: bpy.types.Scene) -> None:
    """The scene's camera, unless it has one."""
    found = graph.components.get(CAMERA)
    if found is None or scene.camera is not None:
        return
    for row in found.rows[np.asarray(found.columns["active"], bool)]:
        scene.camera = objects.get(int(row))
