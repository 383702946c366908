"""From a scenegraph to Blender objects: a whole scene, or some rows added to one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import bpy

from ..errors import UniSGError
from ..scene.components import MATERIALS
from ..scene.graph import SceneGraph
from .lookup import objects_by_uid
from .materials import write_materials
from .report import ReadReport
from .write_components import link_objects, set_visibility
from .write_data import object_data, set_active_camera, set_empties, set_materials
from .write_matrices import place_objects
from .write_properties import write_properties

Objects = dict[int, bpy.types.Object]


@dataclass
class Writer:
    """What stays the same while one scenegraph is written."""

    graph: SceneGraph
    materials: dict[str, bpy.types.Material]
    report: ReadReport
    data: dict[object, bpy.types.ID | None] = field(default_factory=dict)


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
        like the graph when omitted.
    report
        Is told what Blender cannot hold.

    Raises
    ------
    UniSGError
        If a mesh of the graph is damaged; nothing is left behind then.
    """
    made = scene is None
    scene = bpy.data.scenes.new(graph.title) if scene is None else scene
    try:
        write_rows(graph, range(len(graph)), scene, report=report)
    except UniSGError:
        if made:
            bpy.data.scenes.remove(scene)
        raise
    return scene


def write_rows(
    graph: SceneGraph,
    rows: Iterable[int],
    scene: bpy.types.Scene,
    *,
    collection: bpy.types.Collection | None = None,
    report: ReadReport | None = None,
) -> list[bpy.types.Object]:
    """Make objects for some rows of a scenegraph whose other rows stand in the scene already.

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
    report = ReadReport() if report is None else report
    standing = _standing_objects(graph, rows, scene)
    writer = Writer(graph, _used_materials(graph, rows), report)
    _share_meshes(writer, standing)
    objects: Objects = {}
    try:
        for row in rows:
            objects[row] = _new_object(writer, row)
    except UniSGError:
        for item in objects.values():
            bpy.data.objects.remove(item)
        raise
    place_objects(graph, objects, standing, report)
    for row, item in objects.items():
        write_properties(graph, row, item, report)
    set_materials(graph, objects, writer.materials)
    set_empties(graph, objects)
    link_objects(graph, objects, collection or scene.collection, scene)
    set_visibility(graph, objects, scene)
    set_active_camera(graph, objects, scene)
    return [objects[row] for row in rows]


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


def _share_meshes(writer: Writer, standing: Objects) -> None:
    """New objects share the mesh data of standing ones, where modifiers did not make another mesh of them."""
    for row, item in standing.items():
        index = int(writer.graph.mesh[row])
        if index >= 0 and item.type == "MESH" and not item.modifiers and not item.data.shape_keys:
            writer.data.setdefault(("mesh", index), item.data)


def _new_object(writer: Writer, row: int) -> bpy.types.Object:
    graph = writer.graph
    data = object_data(graph, row, writer.data, writer.materials, writer.report)
    item = bpy.data.objects.new(graph.name[row], data)
    if item.name != graph.name[row]:
        writer.report.add(graph.name[row], "has a number or fewer letters in its name in Blender")
    return item
