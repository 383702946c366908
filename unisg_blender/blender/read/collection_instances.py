"""Collections that are instanced, and what geometry nodes, particles and duplication draw."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...runtime.read_report import ReadReport
from ...scene.component_table import Table, table
from ...scene.components import INSTANCES
from ...scene.graph import TYPE_INDEX, SceneGraph
from ...scene.identity import derived_uid
from ...scene.mesh import Mesh
from .mesh_cache import CURVE_LIKE, MeshShelf

UNUSED = 2**31 - 1  # in a persistent id
Entry = tuple[int, SceneGraph, NDArray[np.float64], str]


def instance_table(
    items: Sequence[bpy.types.Object],
    shelf: MeshShelf,
    read_collection: Callable[[bpy.types.Collection], SceneGraph],
    report: ReadReport,
) -> dict[str, Table]:
    """The component ``instances`` of some objects, if there are any.

    Parameters
    ----------
    read_collection
        Gives the scenegraph of an instanced collection, the same object each time.
    """
    entries: list[Entry] = []
    for row, item in enumerate(items):
        if item.instance_type == "COLLECTION" and item.instance_collection is not None:
            prototype = read_collection(item.instance_collection)
            matrix = np.eye(4)
            matrix[:3, 3] = -np.array(item.instance_collection.instance_offset)
            entries.append((row, prototype, matrix, "COLLECTION"))
    entries += _drawn_instances(items, shelf, report)
    if not entries:
        return {}
    rows, prototypes, matrices, sources = zip(*entries, strict=True)
    return {INSTANCES: table(rows, prototype=prototypes, matrix=np.array(matrices), source=sources)}


def _drawn_instances(items: Sequence[bpy.types.Object], shelf: MeshShelf, report: ReadReport) -> list[Entry]:
    """What the depsgraph draws more than once, collection instances left out."""
    rows = {
        item: row
        for row, item in enumerate(items)
        if item.instance_type != "COLLECTION" and (shelf.evaluated or item.instance_type != "NONE")
    }
    inverses: dict[int, NDArray[np.float64] | None] = {}
    prototypes: dict[int, SceneGraph] = {}
    entries: list[Entry] = []
    whole: set[Any] = set()
    for instance in shelf.depsgraph.object_instances:
        if not instance.is_instance or instance.parent is None or instance.object.type == "EMPTY":
            continue
        row = rows.get(instance.parent.original)
        if row is None:
            continue
        if _is_part(instance, whole):
            if instance.object.type not in ("MESH", "POINTCLOUD"):
                report.add(items[row].name, f"geometry of type {instance.object.type.lower()} in it is not read")
                continue
            if instance.object.original.type in CURVE_LIKE:  # its mesh is read with the object
                continue
        if row not in inverses:
            inverses[row] = _inverse(np.array(instance.parent.matrix_world, np.float64))
        inverse, drawn = inverses[row], instance.object
        if inverse is None:
            report.add(items[row].name, "its instances are lost: its scale is zero")
            continue
        key = (drawn.data or drawn).as_pointer()
        if key not in prototypes:
            made = drawn.original == instance.parent.original
            prototypes[key] = _drawn_prototype(drawn, shelf.drawn_mesh(drawn, made))
        entries.append((row, prototypes[key], inverse @ np.array(instance.matrix_world, np.float64), "GEOMETRY"))
    return entries


def _is_part(instance: bpy.types.DepsgraphObjectInstance, whole: set[Any]) -> bool:
    """Whether it is only an object's geometry of another type than its own, such as the surface of a curve.

    Its numbers are those of the object itself behind one more; ``whole`` collects owner, object and numbers of
    objects that were drawn as a whole.
    """
    owner, original = instance.parent.original, instance.object.original
    numbers = tuple(number for number in instance.persistent_id if number != UNUSED)
    above = (owner, original, numbers[1:])
    if instance.object.type != original.type and (above == (owner, owner, ()) or above in whole):
        return True
    whole.add((owner, original, numbers))
    return False


def _inverse(matrix: NDArray[np.float64]) -> NDArray[np.float64] | None:
    return None if abs(np.linalg.det(matrix)) < 1e-15 else np.linalg.inv(matrix)


def _drawn_prototype(drawn: bpy.types.Object, mesh: Mesh | None) -> SceneGraph:
    """A scenegraph of one entity at the origin, with the mesh that is drawn."""
    kind = drawn.type if mesh is None or drawn.type != "POINTCLOUD" else "MESH"
    return SceneGraph(
        name=(drawn.name,),
        uid=(derived_uid("", drawn.name),),
        type=np.array([TYPE_INDEX.get(kind, TYPE_INDEX["OTHER"])], np.int8),
        parent=np.array([-1], np.int32),
        category=np.array([-1], np.int32),
        vocabulary=(),
        local=np.eye(4)[None],
        mesh=np.array([-1 if mesh is None else 0], np.int32),
        meshes=() if mesh is None else (mesh,),
        title=drawn.name,
    )
