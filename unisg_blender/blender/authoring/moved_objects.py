"""Move Blender objects to where they were placed anew, with what holds them there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import mathutils
import numpy as np
from numpy.typing import NDArray

from ...scene.graph import SceneGraph
from ...scene.properties import RELATIONS, relations_of
from ...scene.relation import relations_to_json
from ..lookup import objects_by_uid
from ..scene_units import metres_per_unit, scale_translations

CARRIED = {"on_top_of", "inside", "attached_to", "hangs_from", "beside"}
"""Relations to what held an object where it was."""


@dataclass(frozen=True, eq=False)
class MovedObject:
    """The row of an object, its ``world`` matrix (4, 4) now in metres, the name of its ``carrier`` ("" for the ground),
    and the rows of what stands on it."""

    row: int
    world: NDArray[np.float64]
    carrier: str = ""
    along: tuple[int, ...] = ()


def move_objects(scene: bpy.types.Scene, graph: SceneGraph, moved: Sequence[MovedObject]) -> None:
    """Move the objects at some rows of the scene's scenegraph, the first ones first, and what stands on them.

    What was parented to something that it stood on is parented to what carries it now, always with a parent
    inverse; relations to what held it are taken away. A group stays the parent of what is in it.
    """
    items, units = objects_by_uid(scene), 1.0 / metres_per_unit(scene)
    for each in moved:
        item = items[graph.uid[each.row]]
        old = {row: np.array(items[graph.uid[row]].matrix_world) for row in each.along}
        before = np.array(item.matrix_world)
        _held_anew(scene, graph, each, item)
        item.matrix_world = mathutils.Matrix(scale_translations(each.world, units).tolist())
        bpy.context.view_layer.update()  # parents come first: what is on it is set in the world again
        shift = np.array(item.matrix_world) @ np.linalg.inv(before)
        for row, matrix in old.items():
            items[graph.uid[row]].matrix_world = mathutils.Matrix((shift @ matrix).tolist())
            bpy.context.view_layer.update()


def _held_anew(scene: bpy.types.Scene, graph: SceneGraph, each: MovedObject, item: bpy.types.Object) -> None:
    """Have what carries an object now be its parent, where what carried it was; and its relations true."""
    kept = tuple(relation for relation in relations_of(graph, each.row) if relation.kind not in CARRIED)
    if RELATIONS in item and len(kept) < len(relations_of(graph, each.row)):
        if kept:
            item[RELATIONS] = relations_to_json(kept)
        else:
            del item[RELATIONS]
    parent, carrier = item.parent, scene.objects.get(each.carrier)
    if parent is None or parent == carrier or parent.type != "MESH" or carrier in item.children_recursive:
        return
    world = item.matrix_world.copy()
    item.parent = carrier
    if carrier is not None:
        item.matrix_parent_inverse = carrier.matrix_world.inverted()
    item.matrix_world = world
