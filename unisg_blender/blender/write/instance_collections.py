"""Instances as Blender has them: collections that empties stand for."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import mathutils
import numpy as np
from numpy.typing import NDArray

from ...scene.components import INSTANCES
from ...scene.graph import SceneGraph
from ..helper_objects import new_helper
from .component_entries import Objects


def write_instances(
    graph: SceneGraph, objects: Objects, make_collection: Callable[[SceneGraph], bpy.types.Collection]
) -> list[tuple[bpy.types.Object, bpy.types.Object]]:
    """Set up the instances of new objects.

    An empty with one unturned collection instance is that instancer; all others
    have a helper for each.

    Parameters
    ----------
    make_collection
        Gives the collection of a prototype, the same one each time.

    Returns
    -------
    list
        (helper, the object it belongs to), for linking.
    """
    found = graph.components.get(INSTANCES)
    helpers: list[tuple[bpy.types.Object, bpy.types.Object]] = []
    for row, entries in () if found is None else found.groups():
        item = objects.get(row)
        if item is None:
            continue
        alone = len(entries["matrix"]) == 1 and item.type == "EMPTY"
        for number, (prototype, matrix) in enumerate(zip(entries["prototype"], entries["matrix"], strict=True)):
            collection = make_collection(prototype)
            if alone and _takes_offset(collection, matrix):
                _instance(item, collection)
                continue
            helper = new_helper(f"{item.name} instance {number}", item)  # the number keeps their order
            offset = np.eye(4)
            offset[:3, 3] = collection.instance_offset
            helper.matrix_parent_inverse = mathutils.Matrix(matrix @ offset)
            _instance(helper, collection)
            helpers.append((helper, item))
    return helpers


def _instance(item: bpy.types.Object, collection: bpy.types.Collection) -> None:
    item.instance_type, item.instance_collection = "COLLECTION", collection


def _takes_offset(collection: bpy.types.Collection, matrix: NDArray[np.float64]) -> bool:
    """Whether the collection's offset says the matrix; a collection that nobody instances yet takes it over."""
    if not np.array_equal(matrix[:3, :3], np.eye(3)):
        return False
    if collection.users == 0:
        collection.instance_offset = -matrix[:3, 3]
    return bool(np.allclose(-np.array(collection.instance_offset), matrix[:3, 3], rtol=0, atol=1e-6))
