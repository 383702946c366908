"""The sparse components of objects: how they hang, where they are listed, whether they are seen."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...scene.component_table import Table, table
from ...scene.components import (  # fmt: skip
    BONES,
    CAMERA,
    CHANNELS,
    COLLECTIONS,
    EMPTY,
    LIBRARY,
    LIGHT,
    MATERIALS,
    PARENTING,
    RIGID_BODIES,
    VISIBILITY,
)
from ..rigid_body_objects import rigid_body_table
from .object_data import bone_table, camera_table, empty_table, light_table
from .object_hierarchy import Hierarchy, read_matrices

Items = Sequence[bpy.types.Object]


def component_tables(
    objects: bpy.types.bpy_prop_collection,
    items: Items,
    hierarchy: Hierarchy,
    top: bpy.types.Collection,
    view_layer: bpy.types.ViewLayer,
    depsgraph: bpy.types.Depsgraph,
) -> dict[str, Table]:
    """All tables of :mod:`~unisg_blender.scene.components` that the objects fill without evaluation."""
    tables = {
        PARENTING: parenting_table(items, hierarchy),
        CHANNELS: channel_table(objects, items),
        COLLECTIONS: collection_table(items, top),
        VISIBILITY: visibility_table(objects, items, view_layer),
        MATERIALS: material_table(items),
        LIBRARY: library_table(items),
        CAMERA: camera_table(items, view_layer),
        LIGHT: light_table(items),
        BONES: bone_table(items, depsgraph),
        EMPTY: empty_table(items),
        RIGID_BODIES: rigid_body_table(items),
    }
    return {name: found for name, found in tables.items() if len(found.rows)}


def parenting_table(items: Items, hierarchy: Hierarchy) -> Table:
    """Parents that are a bone, vertices, an armature's or a lattice's deformation."""
    rows = [row for row in hierarchy.special if hierarchy.parent[row] >= 0]
    return table(
        rows,
        kind=[items[row].parent_type for row in rows],
        bone=[items[row].parent_bone for row in rows],
        vertices=np.array([_parent_vertices(items[row]) for row in rows], np.int32).reshape(-1, 3),
        frame=np.array([hierarchy.frames[row] for row in rows]).reshape(-1, 4, 4),
    )


def _parent_vertices(item: bpy.types.Object) -> tuple[int, ...]:
    return tuple(item.parent_vertices) if item.parent_type.startswith("VERTEX") else (0, 0, 0)


def channel_table(objects: bpy.types.bpy_prop_collection, items: Items) -> Table:
    """Location, rotation and scale as they are spelt, for objects with more than XYZ Euler angles."""
    count = len(items)
    values = {
        "location": _floats(objects, "location", count, 3),
        "scale": _floats(objects, "scale", count, 3),
        "delta_location": _floats(objects, "delta_location", count, 3),
        "delta_scale": _floats(objects, "delta_scale", count, 3),
        "inverse": read_matrices(objects, "matrix_parent_inverse", count),
    }
    deltas = _floats(objects, "delta_rotation_euler", count, 3), _floats(objects, "delta_rotation_quaternion", count, 4)
    mode = np.empty(count, np.int32)
    objects.foreach_get("rotation_mode", mode)
    quaternion, angle_axis = mode == 0, mode == -1
    rotation = np.pad(_floats(objects, "rotation_euler", count, 3), ((0, 0), (0, 1)))
    rotation[quaternion] = _floats(objects, "rotation_quaternion", count, 4)[quaternion]
    rotation[angle_axis] = _floats(objects, "rotation_axis_angle", count, 4)[angle_axis]
    turned = np.pad(deltas[0], ((0, 0), (0, 1)))
    turned[quaternion] = deltas[1][quaternion]
    hangs = np.array([item.parent is not None for item in items], bool)
    rest = np.where(quaternion[:, None], (1.0, 0.0, 0.0, 0.0), 0.0)
    rows = np.flatnonzero(
        (mode != 1)
        | (hangs & (values["inverse"] != np.eye(4)).any(axis=(1, 2)))
        | (values["delta_location"] != 0).any(axis=1)
        | (values["delta_scale"] != 1).any(axis=1)
        | (turned != rest).any(axis=1)
    )
    return table(
        rows,
        mode=[items[row].rotation_mode for row in rows],
        rotation=rotation[rows],
        delta_rotation=turned[rows],
        **{name: array[rows] for name, array in values.items()},
    )


def _floats(objects: bpy.types.bpy_prop_collection, name: str, count: int, width: int) -> NDArray[np.float64]:
    buffer = np.empty(count * width, np.float32)
    objects.foreach_get(name, buffer)
    return buffer.reshape(count, width).astype(np.float64)


def collection_table(items: Items, top: bpy.types.Collection) -> Table:
    """Collections below the outermost one, as paths of names."""
    place = {item: row for row, item in enumerate(items)}
    rows: list[int] = []
    paths: list[tuple[str, ...]] = []
    stack: list[tuple[bpy.types.Collection, tuple[str, ...]]] = [
        (child, (child.name,)) for child in reversed(top.children)
    ]
    while stack:
        collection, path = stack.pop()
        found = [place[item] for item in collection.objects if item in place]
        rows += found
        paths += [path] * len(found)
        stack += [(child, (*path, child.name)) for child in reversed(collection.children)]
    return table(rows, path=paths)


def visibility_table(objects: bpy.types.bpy_prop_collection, items: Items, view_layer: bpy.types.ViewLayer) -> Table:
    """Objects hidden by the eye, or disabled in viewports or renders."""
    viewport, render = np.empty(len(items), bool), np.empty(len(items), bool)
    objects.foreach_get("hide_viewport", viewport)
    objects.foreach_get("hide_render", render)
    hidden = np.array([item.hide_get(view_layer=view_layer) for item in items], bool)
    rows = np.flatnonzero(viewport | render | hidden)
    return table(rows, hidden=hidden[rows], viewport=viewport[rows], render=render[rows])


def material_table(items: Items) -> Table:
    """Materials that are linked to the object and not to its mesh."""
    found = [
        (row, index, slot.material.name if slot.material else "")
        for row, item in enumerate(items)
        for index, slot in enumerate(item.material_slots)
        if slot.link == "OBJECT"
    ]
    return table(
        [row for row, _, _ in found],
        slot=np.array([index for _, index, _ in found], np.int32),
        material=[name for _, _, name in found],
    )


def library_table(items: Items) -> Table:
    """Objects that are linked from other files."""
    rows = [row for row, item in enumerate(items) if item.library is not None]
    return table(rows, path=[items[row].library.filepath for row in rows])
