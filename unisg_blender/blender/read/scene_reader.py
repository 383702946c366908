"""From a Blender scene to a scenegraph; reading never writes to the scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import bpy
import numpy as np
from numpy.typing import NDArray

from ...runtime.read_report import ReadReport
from ...scene.assembly import Columns, assemble
from ...scene.component_table import table
from ...scene.components import COLLECTIONS, WORLD
from ...scene.graph import SceneGraph
from ...scene.mesh import Material
from ...scene.properties import ObjectProperties, decode_properties
from ...scene.realize_instances import realize
from ..depsgraph import updated_depsgraph
from ..helper_objects import HELPER, TYPE, fold
from ..id_properties import custom_properties
from ..materials import read_material
from ..scene_frames import read_frame_range
from ..scene_units import in_metres, report_unit
from ..unsupported.of_objects import report_losses
from ..unsupported.of_scenes import report_scene_losses
from .collection_instances import instance_table
from .mesh_cache import MeshShelf
from .object_components import collection_table, component_tables
from .object_hierarchy import read_hierarchy
from .sampled_animation import may_move, sample_animation
from .usd_import import IMPORTED, as_written, is_imported, join_shapes

Geometry = Literal["evaluated", "original", "none"]
BARE = ObjectProperties()
Marks = Mapping[str, object]
UNMARKED: Marks = {}
NEW_NAMES = {"GPENCIL": "GREASEPENCIL"}


@dataclass(frozen=True)
class SceneReader:
    """What stays the same while one scene is read."""

    depsgraph: bpy.types.Depsgraph
    view_layer: bpy.types.ViewLayer
    geometry: Geometry
    details: bool
    animation: bool
    shelf: MeshShelf
    report: ReadReport
    losses: bool  # whether somebody wants to hear what is lost: telling it takes as long as reading
    instances: bool = True  # whether they are read
    prototypes: dict[bpy.types.Collection, SceneGraph] = field(default_factory=dict)

    def read_collection(self, collection: bpy.types.Collection) -> SceneGraph:
        """The scenegraph of an instanced collection, read once."""
        if collection not in self.prototypes:
            self.prototypes[collection] = read_objects(collection.all_objects, collection.name, collection, self)
        return self.prototypes[collection]


def read_scene(
    scene: bpy.types.Scene | None = None,
    *,
    geometry: Geometry = "evaluated",
    details: bool = True,
    instances: Literal["kept", "realized", "as details"] = "as details",
    animation: bool = False,
    report: ReadReport | None = None,
    progress: Callable[[int, int], None] | None = None,
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
        False reads hierarchy, matrices, geometry and custom properties only (categories,
        behaviour and relations among them) and collections: enough for whoever does not write the scene
        into a file.
    instances
        Of collections, and those that geometry nodes and particles make: "kept" as
        the component ``instances``, or "realized" as entities; kept with the details if nothing is said.
    animation
        Step through the scene's frames and keep how its objects move, as the component
        ``animation``; the scene ends at the frame where it was.
    report
        Is told, per object, what a scenegraph cannot hold; without one, nothing is looked up for it.
    progress
        Called with (frames done, frames in all) while motion is read.

    Returns
    -------
    SceneGraph
        All objects of the scene as entities, in canonical order; metres whatever the scene's unit, Z up.
    """
    scene = scene or bpy.context.scene
    losses, report = details and report is not None, ReadReport() if report is None else report
    view_layer, depsgraph = updated_depsgraph(scene)
    shelf = MeshShelf(depsgraph, geometry == "evaluated", report)
    shown = details or instances != "as details"
    reader = SceneReader(depsgraph, view_layer, geometry, details, animation, shelf, report, losses, shown)
    graph = read_objects(scene.objects, scene.name, scene.collection, reader)
    graph = in_metres(graph, scene).replace(frames=read_frame_range(scene, report))
    report_unit(scene, report)
    if losses:
        report_scene_losses(scene, view_layer, report)
    if animation and may_move(scene):
        graph = sample_animation(graph, scene, progress=progress, report=report)
    return realize(graph) if instances == "realized" else graph


def read_scenes(
    *, geometry: Geometry = "evaluated", details: bool = True, report: ReadReport | None = None
) -> dict[str, SceneGraph]:
    """The scenegraphs of all scenes of the open file, by scene name."""
    return {
        scene.name: read_scene(scene, geometry=geometry, details=details, report=report) for scene in bpy.data.scenes
    }


def read_collection(collection: bpy.types.Collection, scene: bpy.types.Scene) -> SceneGraph:
    """The scenegraph of a collection as its instances show it, in metres by a scene's unit, without details."""
    view_layer, depsgraph = updated_depsgraph(scene)
    report = ReadReport()
    shelf = MeshShelf(depsgraph, True, report)
    reader = SceneReader(depsgraph, view_layer, "evaluated", False, False, shelf, report, False)
    graph = read_objects(collection.all_objects, collection.name, collection, reader)
    local = graph.local.copy()
    local[graph.parent < 0, :3, 3] -= np.array(collection.instance_offset)
    return in_metres(graph.replace(local=local), scene)


def read_objects(
    objects: bpy.types.bpy_prop_collection, title: str, top: bpy.types.Collection, reader: SceneReader
) -> SceneGraph:
    """The scenegraph of the objects of a scene or of a collection, whose outermost collection is ``top``."""
    items = list(objects)
    hierarchy = read_hierarchy(objects, items, reader.depsgraph)
    for row in hierarchy.broken:
        reader.report.add(items[row].name, "its transform is no finite matrix; left out")
    found = [_properties(item, reader.report) for item in items]
    mesh = np.full(len(items), -1, np.int32) if reader.geometry == "none" else reader.shelf.column(items)
    components = {
        WORLD: table(hierarchy.moved, matrix=hierarchy.world),
        HELPER: table([row for row, (_, marks) in enumerate(found) if HELPER in marks]),
        IMPORTED: table([row for row, (_, marks) in enumerate(found) if IMPORTED in marks]),
    }
    components[COLLECTIONS] = collection_table(items, top)
    if reader.details:
        components |= component_tables(objects, items, hierarchy, top, reader.view_layer, reader.depsgraph)
    if reader.instances:
        components |= instance_table(items, reader.shelf, reader.read_collection, reader.report)
    if reader.losses:
        instanced = not top.is_embedded_data  # a scene's own collection is part of it
        sampled = reader.animation and not instanced
        evaluated = reader.geometry == "evaluated"
        report_losses(objects, items, reader.depsgraph, evaluated, instanced, sampled, reader.report)
    graph = assemble(
        Columns(
            name=[item.name for item in items],
            type=_types(items, [marks for _, marks in found]),
            parent=hierarchy.parent,
            local=hierarchy.local,
            mesh=mesh,
            meshes=reader.shelf.meshes,
            properties=[properties for properties, _ in found],
            materials=_materials(items, mesh, reader),
            components={name: component for name, component in components.items() if len(component.rows)},
            title=title,
        )
    )
    return join_shapes(fold(_with_used_meshes(graph)))


def _properties(item: bpy.types.Object, report: ReadReport) -> tuple[ObjectProperties, Marks]:
    """An object's custom properties, and apart from them the marks that our own writing left."""
    if not item.keys():
        return BARE, UNMARKED
    values = custom_properties(item)
    imported = is_imported(values)
    values = as_written(values)
    marks = {key: values.pop(key) for key in (TYPE, HELPER) if key in values} | ({IMPORTED: 1} if imported else {})
    found = decode_properties(values)
    for problem in found.problems:
        report.add(item.name, problem)
    return found, marks


def _types(items: Sequence[bpy.types.Object], marks: Sequence[Marks]) -> list[str]:
    """Types by today's names; objects that writing turned into meshes say what they were."""
    types = [item.type for item in items]
    for row, mark in enumerate(marks):
        if mark and types[row] == "MESH":
            types[row] = str(mark.get(TYPE, "MESH"))
    return [NEW_NAMES.get(kind, kind) for kind in types] if "GPENCIL" in types else types


def _with_used_meshes(graph: SceneGraph) -> SceneGraph:
    """The scenegraph without the meshes that only others read with the same shelf have."""
    used = np.unique(graph.mesh[graph.mesh >= 0])
    if len(used) == len(graph.meshes):
        return graph
    place = np.full(len(graph.meshes) + 1, -1, np.int32)
    place[used] = np.arange(len(used))
    return graph.replace(mesh=place[graph.mesh], meshes=tuple(graph.meshes[index] for index in used))


def _materials(items: Sequence[bpy.types.Object], mesh: NDArray[np.int32], reader: SceneReader) -> dict[str, Material]:
    """The materials of meshes and objects, by name."""
    if reader.geometry == "none":
        return {}
    names = {name for index in np.unique(mesh[mesh >= 0]) for name in reader.shelf.meshes[index].materials}
    if reader.details:
        slots = (slot for item in items for slot in item.material_slots if slot.link == "OBJECT" and slot.material)
        names |= {slot.material.name for slot in slots}
    found = {name: bpy.data.materials.get(name) for name in sorted(names)}
    return {name: read_material(material) for name, material in found.items() if material is not None}
