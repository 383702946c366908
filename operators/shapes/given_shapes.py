"""Shapes for the generator out of objects and collections, and the other way round what shows them in the scene."""

from __future__ import annotations

import random
from collections.abc import Generator, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...unisg_blender.errors import UniSGError
from ..preferences import preference
from .shape_sources import source_of

if TYPE_CHECKING:
    from ...unisg_blender.blender.assets.shape_data import ShapeData
    from ...unisg_blender.dataset.assets.asset import Asset
    from ...unisg_blender.generate import Generated

MOST = 6
"""Shapes of a category that are opened at a time."""

SIZE = 0.2
"""Metres of the axes of an empty that shows an instance."""


def given_shapes(
    scene: bpy.types.Scene, categories: Iterable[str], seed: int
) -> Generator[tuple[float, str], None, dict[str, list[Asset]]]:
    """The shapes of some categories that come from what was chosen, from this file's assets, and from libraries.

    Opens what is in other files, one shape a step.
    """
    found: dict[str, list[Asset]] = {}
    for category in categories:
        shapes = source_of(scene, category).shapes
        for shape in random.Random(f"{seed} {category}").sample(shapes, min(len(shapes), MOST)):
            yield 0.0, f"Opening {shape.name}"
            found.setdefault(category, []).append(opened_asset(scene, category, shape))
    return found


def opened_asset(scene: bpy.types.Scene, category: str, shape: ShapeData) -> Asset:
    """An asset of an object or a collection, taken from its file if it is not here.

    Raises
    ------
    UniSGError
        If it has gone, or has no mesh.
    """
    from ...unisg_blender.blender.assets.shape_data import OBJECT, as_shown, read_shape, taken
    from ...unisg_blender.dataset.assets.asset import Asset, object_graph, whole_thing

    here = as_shown(taken(shape, preference("use") == "LINK"))
    graph = read_shape(here, scene)
    if here.kind == OBJECT:
        return replace(object_graph(graph, 0, np.zeros(len(graph), np.int64)), category=category, source=here.text)
    return Asset(category, whole_thing(graph, here.name), source=here.text)


def without_parts(result: Generated) -> Generated:
    """The same without the new rows of what an instance shows."""
    from ...unisg_blender.blender.assets.shape_data import COLLECTION, from_text

    things = {item.uid: item.source for item in result.objects if item.uid}
    shown = {uid for uid, source in things.items() if source and from_text(source).kind == COLLECTION}
    if not shown:
        return result
    scene, new = result.scene, set(result.rows.tolist())
    kept = []
    for row in result.rows.tolist():
        top = row
        while scene.uid[top] not in things and int(scene.parent[top]) in new:
            top = int(scene.parent[top])
        if top == row or scene.uid[top] not in shown:
            kept.append(row)
    return replace(result, rows=np.array(kept, np.int64))


def check_sources(result: Generated) -> None:
    """Raise UniSGError if what is to show new things has gone meanwhile."""
    for shape in _sources(result).values():
        if shape.found() is None:
            raise UniSGError(f"{shape.name!r}, which was to be shown, has gone")


def show_sources(result: Generated, objects: Iterable[bpy.types.Object]) -> None:
    """Let new objects share the data of what they were made of, or show an instance of it."""
    sources = _sources(result)
    for item in objects:
        shape = sources.get(str(item.get("unisg_uid", "")))
        if shape is None:
            continue
        found = shape.found()
        if isinstance(found, bpy.types.Collection):
            item.instance_type, item.instance_collection = "COLLECTION", found
            item.empty_display_size = SIZE
        else:
            _share(item, found)


def _sources(result: Generated) -> dict[str, ShapeData]:
    from ...unisg_blender.blender.assets.shape_data import from_text

    return {item.uid: from_text(item.source) for item in result.objects if item.uid and item.source}


def _share(item: bpy.types.Object, other: bpy.types.Object) -> None:
    """Let an object have the mesh and the materials of another one, and let go of its own."""
    own, item.data = item.data, other.data
    for slot, others in zip(item.material_slots, other.material_slots, strict=True):
        if others.link == "OBJECT":
            slot.link, slot.material = "OBJECT", others.material
    if own is not None and own != other.data and not own.users:
        materials = [material for material in own.materials if material is not None]
        bpy.data.meshes.remove(own)
        for material in materials:
            if not material.users and material.name not in other.data.materials:
                bpy.data.materials.remove(material)
