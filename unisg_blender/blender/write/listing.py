"""Where new objects are listed, and whether they are seen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import bpy
import numpy as np

from ...scene.components import COLLECTIONS, VISIBILITY
from ...scene.graph import SceneGraph

Objects = Mapping[int, bpy.types.Object]


def link_objects(graph: SceneGraph, objects: Objects, default: bpy.types.Collection, top: bpy.types.Collection) -> None:
    """Link every object into its collections, made where they are missing; others into ``default``.

    Paths of collections begin under ``top``.
    """
    found = graph.components.get(COLLECTIONS)
    members: dict[tuple[str, ...], dict[int, None]] = {}
    for row, path in () if found is None else zip(found.rows.tolist(), found.columns["path"], strict=True):
        if row in objects:
            members.setdefault(tuple(path), {})[row] = None
    made: dict[tuple[str, ...], bpy.types.Collection] = {(): top}
    new: list[tuple[bpy.types.Collection, bpy.types.Collection]] = []
    for path, rows in members.items():
        collection = _collection(path, made, new)
        for row in rows:
            collection.objects.link(objects[row])
    for above, collection in reversed(new):  # deepest first, each when it is full
        above.children.link(collection)
    listed = {row for rows in members.values() for row in rows}
    for row, item in objects.items():
        if row not in listed:
            default.objects.link(item)


def _collection(
    path: tuple[str, ...],
    made: dict[tuple[str, ...], bpy.types.Collection],
    new: list[tuple[bpy.types.Collection, bpy.types.Collection]],
) -> bpy.types.Collection:
    """The collection of a path, found by name or made; ``new`` collects (above, made) for linking."""
    if path not in made:
        above = _collection(path[:-1], made, new)
        made[path] = above.children.get(path[-1]) or bpy.data.collections.new(path[-1])
        if made[path].users == 0:
            new.append((above, made[path]))
    return made[path]


def link_helpers(helpers: Sequence[tuple[bpy.types.Object, bpy.types.Object]]) -> None:
    """Link helpers into the collections of the objects they belong to."""
    for helper, owner in helpers:
        for collection in owner.users_collection:
            collection.objects.link(helper)


def set_visibility(graph: SceneGraph, objects: Objects, scene: bpy.types.Scene | None) -> None:
    """Hide what is hidden: by the eye (of a scene), in viewports, in renders."""
    found = graph.components.get(VISIBILITY)
    if found is None:
        return
    columns = found.columns
    hides = scene is not None and bool(columns["hidden"][np.isin(found.rows, list(objects))].any())
    layers = list(scene.view_layers) if scene is not None and hides else []
    for layer in layers:
        layer.update()  # else it does not know the new objects
    for place, row in enumerate(found.rows.tolist()):
        item = objects.get(row)
        if item is None:
            continue
        item.hide_viewport = bool(columns["viewport"][place])
        item.hide_render = bool(columns["render"][place])
        for layer in layers if columns["hidden"][place] else ():
            if item.name in layer.objects:
                item.hide_set(True, view_layer=layer)
