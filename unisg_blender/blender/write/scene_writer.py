"""From a scenegraph to Blender objects: a whole scene, or some rows added to one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import bpy

from ...errors import UniSGError
from ...runtime.read_report import ReadReport
from ...scene import components
from ...scene.components import INSTANCES, MATERIALS
from ...scene.graph import SceneGraph
from ..lookup import objects_by_uid
from ..materials import write_materials
from ..rigid_body_objects import set_rigid_bodies
from ..scene_frames import set_frame_range
from ..scene_units import in_scene_units
from .animation_curves import write_animation
from .bones import write_bones
from .instance_collections import write_instances
from .listing import link_helpers, link_objects, set_visibility
from .mesh_data import check_mesh
from .new_object_data import object_data, set_active_camera, set_empties, set_materials
from .object_matrices import place_objects
from .row_properties import write_properties

Objects = dict[int, bpy.types.Object]
KEPT = frozenset((
    components.ACTIONS, components.LSA, components.RELATIONS, components.PROPERTIES, components.WORLD,
    components.PARENTING, components.CHANNELS, components.COLLECTIONS, components.VISIBILITY, components.MATERIALS,
    components.CAMERA, components.LIGHT, components.BONES, components.EMPTY, components.INSTANCES,
    components.ANIMATION, components.RIGID_BODIES,
))  # fmt: skip
"""Components that Blender has a place for."""


@dataclass
class SceneWriter:
    """What stays the same while one scenegraph and the prototypes of its instances are written."""

    report: ReadReport
    materials: dict[str, bpy.types.Material] = field(default_factory=dict)
    data: dict[object, bpy.types.ID | None] = field(default_factory=dict)
    collections: dict[int, bpy.types.Collection] = field(default_factory=dict)

    def prototype_collection(self, prototype: SceneGraph) -> bpy.types.Collection:
        """The collection of an instanced scenegraph, made once."""
        if id(prototype) not in self.collections:
            collection = self.collections[id(prototype)] = bpy.data.collections.new(prototype.title)
            write_objects(prototype, range(len(prototype)), {}, InsertionPoint(collection, collection, None), self)
        return self.collections[id(prototype)]


@dataclass(frozen=True)
class InsertionPoint:
    """Where new objects go: collections hang under ``top``, objects in none go into ``default``; no scene: unseen."""

    top: bpy.types.Collection
    default: bpy.types.Collection
    scene: bpy.types.Scene | None


def write_scene(
    graph: SceneGraph, scene: bpy.types.Scene | None = None, *, report: ReadReport | None = None
) -> bpy.types.Scene:
    """Make an object for every entity.

    Parameters
    ----------
    graph
        What to write.
    scene
        Where the new objects go, beside those that are there; a new scene named
        like the graph, its unit the metre, when omitted.
    report
        Is told what Blender cannot hold.

    Raises
    ------
    UniSGError
        If a mesh of the graph is damaged; nothing is left behind then.
    """
    check_graph(graph, range(len(graph)))
    if scene is None:
        scene = bpy.data.scenes.new(graph.title)
        set_frame_range(graph, scene, ReadReport() if report is None else report)
    write_rows(graph, range(len(graph)), scene, report=report)
    return scene


def write_rows(
    graph: SceneGraph,
    rows: Iterable[int],
    scene: bpy.types.Scene,
    *,
    collection: bpy.types.Collection | None = None,
    report: ReadReport | None = None,
) -> list[bpy.types.Object]:
    """Make objects for some rows of a scenegraph whose other rows stand in the scene already, in the scene's unit.

    Parents are found among the new objects or, by uid, in the scene; a mesh that an
    entity of the scene uses unmodified is shared with it.

    Parameters
    ----------
    rows
        Rows to write.
    collection
        Takes the new objects that the graph lists in no collection; the scene's
        own when omitted.

    Returns
    -------
    list
        The new objects, in the order of ``rows``.

    Raises
    ------
    UniSGError
        If a mesh is damaged, or a parent is neither among the rows nor in the scene.
    """
    rows = [int(row) for row in rows]
    check_graph(graph, rows)
    graph = in_scene_units(graph, scene)
    standing = _standing_objects(graph, rows, scene)
    writer = SceneWriter(ReadReport() if report is None else report)
    for name in sorted(set(graph.components) - KEPT):
        writer.report.add("", f"the component {name!r} has no place in Blender")
    _share_meshes(graph, standing, writer)
    place = InsertionPoint(scene.collection, collection or scene.collection, scene)
    return write_objects(graph, rows, standing, place, writer)


def check_graph(graph: SceneGraph, rows: Iterable[int]) -> None:
    """Raise UniSGError before anything is made if a mesh of these rows or of their instances is damaged."""
    rows = set(rows)
    for index in {int(graph.mesh[row]) for row in rows} - {-1}:
        check_mesh(graph.meshes[index])
    found = graph.components.get(INSTANCES)
    if found is not None:
        used = {id(item): item for row in rows for item in found.of(row)["prototype"]}
        for prototype in used.values():
            check_graph(prototype, range(len(prototype)))


def write_objects(
    graph: SceneGraph, rows: Iterable[int], standing: Objects, place: InsertionPoint, writer: SceneWriter
) -> list[bpy.types.Object]:
    """Make objects for rows of a checked scenegraph; ``standing`` are the objects of other rows."""
    rows = list(rows)
    writer.materials |= _used_materials(graph, rows)
    objects = {row: _new_object(graph, row, writer) for row in rows}
    write_bones(graph, objects, writer.report)
    helpers = place_objects(graph, objects, standing, writer.report)
    helpers += write_instances(graph, objects, writer.prototype_collection)
    for row, item in objects.items():
        write_properties(graph, row, item, writer.report)
    set_materials(graph, objects, writer.materials)
    set_empties(graph, objects)
    link_objects(graph, objects, place.default, place.top)
    link_helpers(helpers)
    set_visibility(graph, objects, place.scene)
    if place.scene is not None:
        set_active_camera(graph, objects, place.scene)
        set_rigid_bodies(graph, objects, place.scene)
        write_animation(graph, objects, place.scene, writer.report)
    return list(objects.values())


def _standing_objects(graph: SceneGraph, rows: Sequence[int], scene: bpy.types.Scene) -> Objects:
    """Objects of the scene that stand for rows which are not to be written."""
    new = set(rows)
    if len(new) == len(graph):
        return {}
    found = objects_by_uid(scene)
    standing = {row: found[uid] for row, uid in enumerate(graph.uid) if row not in new and uid in found}
    for row in rows:
        above = int(graph.parent[row])
        if above >= 0 and above not in new and above not in standing:
            raise UniSGError(f"the parent of {graph.name[row]!r}, {graph.name[above]!r}, is not in the scene")
    return standing


def _used_materials(graph: SceneGraph, rows: Sequence[int]) -> dict[str, bpy.types.Material]:
    meshes = {int(graph.mesh[row]) for row in rows} - {-1}
    names = {name for index in meshes for name in graph.meshes[index].materials}
    extra = graph.components.get(MATERIALS)
    names |= set() if extra is None else set(extra.columns["material"])
    return write_materials(graph.materials[name] for name in sorted(names) if name in graph.materials)


def _share_meshes(graph: SceneGraph, standing: Objects, writer: SceneWriter) -> None:
    """New objects share the mesh data of standing ones, where modifiers did not make another mesh of them."""
    for row, item in standing.items():
        index = int(graph.mesh[row])
        if index >= 0 and item.type == "MESH" and not item.modifiers and not item.data.shape_keys:
            writer.data.setdefault(id(graph.meshes[index]), item.data)


def _new_object(graph: SceneGraph, row: int, writer: SceneWriter) -> bpy.types.Object:
    data = object_data(graph, row, writer.data, writer.materials, writer.report)
    item = bpy.data.objects.new(graph.name[row], data)
    if item.name != graph.name[row]:
        writer.report.add(graph.name[row], "has a number or fewer letters in its name in Blender")
    return item
