"""From a Blender scene to a scenegraph; reading never writes to the scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import bpy
import numpy as np

from ..scene.assemble import Columns, assemble
from ..scene.components import WORLD
from ..scene.graph import SceneGraph, Table, table
from ..scene.mesh import Material
from ..scene.properties import ObjectProperties, decode_properties
from .custom_properties import custom_properties
from .hierarchy import read_hierarchy
from .losses import report_losses
from .materials import read_material
from .read_components import component_tables
from .read_geometry import MeshShelf
from .report import ReadReport

Geometry = Literal["evaluated", "original", "none"]
BARE = ObjectProperties()
NEW_NAMES = {"GPENCIL": "GREASEPENCIL"}


@dataclass(frozen=True)
class Reader:
    """What stays the same while one scene is read."""

    depsgraph: bpy.types.Depsgraph
    view_layer: bpy.types.ViewLayer
    active: bool  # Blender keeps matrix_world up to date with this depsgraph
    geometry: Geometry
    details: bool
    shelf: MeshShelf
    report: ReadReport


def read_scene(
    scene: bpy.types.Scene | None = None,
    *,
    geometry: Geometry = "evaluated",
    details: bool = True,
    report: ReadReport | None = None,
) -> SceneGraph:
    """The scenegraph of a scene.

    Parameters
    ----------
    scene
        The current scene when omitted.
    geometry
        "evaluated": meshes as modifiers and shape keys leave them, curves and
        texts as meshes; "original": meshes as they are edited; "none".
    details
        False reads hierarchy, matrices, geometry and custom properties only,
        no other component.
    report
        Is told, per object, what a scenegraph cannot hold.

    Returns
    -------
    SceneGraph
        All objects of the scene as entities, in canonical order; metres, Z up.
    """
    scene = scene or bpy.context.scene
    report = ReadReport() if report is None else report
    active = scene == bpy.context.scene
    view_layer = bpy.context.view_layer if active else scene.view_layers[0]
    depsgraph = _updated_depsgraph(view_layer, active)
    shelf = MeshShelf(depsgraph, geometry == "evaluated", report)
    reader = Reader(depsgraph, view_layer, active, geometry, details, shelf, report)
    return read_objects(scene.objects, scene.name, scene.collection, reader)


def read_scenes(
    *, geometry: Geometry = "evaluated", details: bool = True, report: ReadReport | None = None
) -> dict[str, SceneGraph]:
    """The scenegraphs of all scenes of the open file, by scene name."""
    return {
        scene.name: read_scene(scene, geometry=geometry, details=details, report=report) for scene in bpy.data.scenes
    }


def _updated_depsgraph(view_layer: bpy.types.ViewLayer, active: bool) -> bpy.types.Depsgraph:
    if active:
        return bpy.context.evaluated_depsgraph_get()
    view_layer.update()
    return view_layer.depsgraph


def read_objects(
    objects: bpy.types.bpy_prop_collection, title: str, top: bpy.types.Collection, reader: Reader
) -> SceneGraph:
    """The scenegraph of the objects of a scene or of a collection, whose outermost collection is ``top``."""
    items = list(objects)
    hierarchy = read_hierarchy(objects, items, reader.depsgraph, reader.active)
    properties = [_properties(item, reader.report) for item in items]
    mesh = np.full(len(items), -1, np.int32) if reader.geometry == "none" else reader.shelf.column(items)
    components: dict[str, Table] = {}
    if len(hierarchy.moved):
        components[WORLD] = table(hierarchy.moved, matrix=hierarchy.world)
    if reader.details:
        components |= component_tables(objects, items, hierarchy, top, reader.view_layer)
        report_losses(items, reader.depsgraph, reader.geometry == "evaluated", reader.report)
    return assemble(
        Columns(
            name=[item.name for item in items],
            type=[NEW_NAMES.get(item.type, item.type) for item in items],
            parent=hierarchy.parent,
            local=hierarchy.local,
            mesh=mesh,
            meshes=reader.shelf.meshes,
            properties=properties,
            materials=_materials(items, reader) if reader.geometry != "none" else {},
            components=components,
            title=title,
        )
    )


def _properties(item: bpy.types.Object, report: ReadReport) -> ObjectProperties:
    if not item.keys():
        return BARE
    found = decode_properties(custom_properties(item))
    for problem in found.problems:
        report.add(item.name, problem)
    return found


def _materials(items: Sequence[bpy.types.Object], reader: Reader) -> dict[str, Material]:
    owners = {item.data: item for item in items if item.data is not None and hasattr(item.data, "materials")}
    used = {material for data in owners for material in data.materials if material is not None}
    if reader.details:
        for item in items:
            used |= {slot.material for slot in item.material_slots if slot.link == "OBJECT" and slot.material}
    for mesh in reader.shelf.meshes:  # modifiers may bring materials of their own
        named = (bpy.data.materials.get(name) for name in mesh.materials)
        used |= {material for material in named if material is not None}
    return {material.name: read_material(material) for material in sorted(used, key=lambda item: item.name)}
