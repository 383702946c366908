"""The data of new objects: meshes, cameras, lights, armatures and the rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import bpy
import numpy as np

from ...runtime.read_report import ReadReport
from ...scene.components import CAMERA, EMPTY, MATERIALS
from ...scene.graph import TYPES, SceneGraph
from ...scene.mesh import Mesh
from ..data_fields import ABSENT, BLENDER_NAME, CAMERA_NUMBERS, FOCUS, LIGHT_NUMBERS, LIGHT_SWITCHES
from .component_entries import Objects, entries
from .mesh_data import write_mesh

Made = dict[object, bpy.types.ID | None]


def object_data(
    graph: SceneGraph, row: int, made: Made, materials: Mapping[str, bpy.types.Material], report: ReadReport
) -> bpy.types.ID | None:
    """The data-block of one row, shared with the rows that share it; None for empties.

    ``made`` collects what was made so far.
    """
    kind = TYPES[graph.type[row]]
    mesh = graph.meshes[graph.mesh[row]] if graph.mesh[row] >= 0 else None
    if mesh is not None and kind == "POINTCLOUD" and hasattr(bpy.types.PointCloud, "resize"):
        return _shared(made, id(mesh), lambda: _point_cloud(mesh))
    if mesh is not None:
        if kind != "MESH":
            report.add(graph.name[row], f"is a mesh in Blender, no longer of type {kind.lower()}")
        return _shared(made, id(mesh), lambda: write_mesh(mesh, materials))
    if kind in ("EMPTY", "OTHER"):
        return None
    table = graph.components.get(kind.lower())
    entry = {} if table is None else {key: column[0] for key, column in table.of(row).items() if len(column)}
    name = str(entry.get("data", graph.name[row]))
    key = (kind, name) if "data" in entry else (id(graph), row)
    if kind == "CAMERA":
        return _shared(made, key, lambda: _camera(name, entry))
    if kind == "LIGHT":
        return _shared(made, key, lambda: _light(name, entry, report))
    return _MAKERS[kind](name)


def _shared(made: Made, key: object, make: Callable[[], bpy.types.ID]) -> bpy.types.ID | None:
    if key not in made:
        made[key] = make()
    return made[key]


def _point_cloud(mesh: Mesh) -> bpy.types.PointCloud:
    cloud = bpy.data.pointclouds.new(mesh.name)
    cloud.resize(len(mesh.points))
    if len(mesh.points):
        cloud.attributes["position"].data.foreach_set("vector", np.ascontiguousarray(mesh.points).ravel())
    return cloud


def _grease_pencil(name: str) -> bpy.types.ID:
    new_kind = hasattr(bpy.data, "grease_pencils_v3")  # one name again from 5.0 on
    return (bpy.data.grease_pencils_v3 if new_kind else bpy.data.grease_pencils).new(name)


_MAKERS: dict[str, Callable[[str], bpy.types.ID]] = {
    "MESH": lambda name: bpy.data.meshes.new(name),
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


def _camera(name: str, entry: Mapping[str, Any]) -> bpy.types.Camera:
    camera = bpy.data.cameras.new(name)
    if not entry:
        return camera
    camera.type, camera.sensor_fit = str(entry["kind"]), str(entry["fit"])
    for key in CAMERA_NUMBERS:
        setattr(camera, key, float(entry[key]))
    for key, own in FOCUS.items():
        if key in entry:
            setattr(camera.dof, own, entry[key].item())
    return camera


def _light(name: str, entry: Mapping[str, Any], report: ReadReport) -> bpy.types.Light:
    light = bpy.data.lights.new(name, str(entry.get("kind", "POINT")))
    if not entry:
        return light
    light.color = tuple(entry["color"])
    if entry["shape"]:
        light.shape = str(entry["shape"])
    for key in (*LIGHT_NUMBERS, *LIGHT_SWITCHES):
        own = BLENDER_NAME.get(key, key)
        if key in entry and hasattr(light, own):
            setattr(light, own, entry[key].item())
        elif key in ("exposure", "tinted", "normalize") and key in entry and entry[key] != ABSENT.get(key, 0):
            report.add(name, f"this Blender has no {key} of lights")
    return light


def set_empties(graph: SceneGraph, objects: Objects) -> None:
    """How empties are drawn."""
    for _, item, entry in entries(graph, EMPTY, objects):
        if item.data is None:
            item.empty_display_type, item.empty_display_size = str(entry["display"]), float(entry["size"])


def set_materials(graph: SceneGraph, objects: Objects, materials: Mapping[str, bpy.types.Material]) -> None:
    """Materials that belong to the object and not to its mesh."""
    for _, item, entry in entries(graph, MATERIALS, objects):
        if entry["slot"] < len(item.material_slots):
            slot = item.material_slots[int(entry["slot"])]
            slot.link, slot.material = "OBJECT", materials.get(str(entry["material"]))


def set_active_camera(graph: SceneGraph, objects: Objects, scene: bpy.types.Scene) -> None:
    """The scene's camera, unless it has one."""
    if scene.camera is None:
        active = [item for _, item, entry in entries(graph, CAMERA, objects) if entry["active"]]
        scene.camera = active[-1] if active else None
