"""A collection as the thing that is placed: an empty that shows an instance of it, nothing copied."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import bpy

from ...unisg_blender.errors import UniSGError

if TYPE_CHECKING:
    from ...unisg_blender.generate import Generated
    from ...unisg_blender.scene import SceneGraph


def read_shown(scene: bpy.types.Scene, name: str) -> SceneGraph:
    """What an instance of a collection shows.

    Raises
    ------
    UniSGError
        If there is no such collection, or nothing in it has a shape.
    """
    from ...unisg_blender.blender.read.scene_reader import read_collection

    collection = bpy.data.collections.get(name)
    if collection is None:
        raise UniSGError(f"{name!r} is no collection of this file")
    graph = read_collection(collection, scene)
    if not (graph.mesh >= 0).any():
        raise UniSGError(f"the collection {name!r} shows nothing that could be placed")
    return graph


def instanced(result: Generated) -> Generated:
    """The same with the first new row only, the empty: what is below it the instance shows."""
    new = set(result.rows.tolist())
    return replace(result, rows=result.rows[[int(result.scene.parent[row]) not in new for row in result.rows]])


def show_collection(item: bpy.types.Object, name: str) -> None:
    """Let an empty show an instance of a collection."""
    item.instance_type, item.instance_collection = "COLLECTION", bpy.data.collections[name]
