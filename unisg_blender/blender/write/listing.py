"""Where new objects are listed, and whether they are seen."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...scene.components import COLLECTIONS, VISIBILITY
from ...scene.graph import SceneGraph
from .component_entries import Objects, entries


def link_objects(graph: SceneGraph, objects: Objects, default: bpy.types.Collection, top: bpy.types.Collection) -> None:
    """Link every object into its collections, made where they are missing; others into ``default``.

    Paths of collections begin under ``top``. Collections of other files take nothing: what would be in one goes into
    ``default`` too.
    """
    members: dict[tuple[str, ...], dict[int, None]] = {}
    for row, _, entry in entries(graph, COLLECTIONS, objects):
        members.setdefault(tuple(entry["path"]), {})[row] = None
    made: dict[tuple[str, ...], bpy.types.Collection] = {(): top}
    new: list[tuple[bpy.types.Collection, bpy.types.Collection]] = []
    listed: set[int] = set()
    for path, rows in members.items():
        collection = _collection(path, made, new)
        for row in rows if is_own(collection) else ():
            collection.objects.link(objects[row])
            listed.add(row)
    for above, collection in reversed(new):  # deepest first, each when it is full
        above.children.link(collection)
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
        found = above.children.get(path[-1]) or (None if is_own(above) else above)
        made[path] = found or bpy.data.collections.new(path[-1])
        if made[path].users == 0:
            new.append((above, made[path]))
    return made[path]


def is_own(collection: bpy.types.Collection) -> bool:
    """Whether objects can be linked into a collection: it is of this file, and no override of another file's."""
    return collection.library is None and collection.override_library is None


def link_helpers(helpers: Sequence[tuple[bpy.types.Object, bpy.types.Object]]) -> None:
    """Link helpers into the collections of the objects they belong to."""
    for helper, owner in helpers:
        for collection in owner.users_collection:
            collection.objects.link(helper)


def set_visibility(graph: SceneGraph, objects: Objects, scene: bpy.types.Scene | None) -> None:
    """Hide what is hidden: by the eye (of a scene), in viewports, in renders."""
    found = list(entries(graph, VISIBILITY, objects))
    hides = scene is not None and any(entry["hidden"] for _, _, entry in found)
    layers = list(scene.view_layers) if scene is not None and hides else []
    for layer in layers:
        layer.update()  # else it does not know the new objects
    for _, item, entry in found:
        item.hide_viewport, item.hide_render = bool(entry["viewport"]), bool(entry["render"])
        for layer in layers if entry["hidden"] else ():
            if item.name in layer.objects:
                item.hide_set(True, view_layer=layer)
