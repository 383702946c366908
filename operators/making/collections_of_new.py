"""New objects go to the collection in which what holds them is, or most of the room."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import bpy


def put_beside(scene: bpy.types.Scene, new: Sequence[bpy.types.Object]) -> None:
    """Move new objects from the scene's own collection to that of their parent, or of most of the scene's things.

    Objects of a scene without collections stay. Parents come before their children.
    """
    theirs = {item.name for item in scene.collection.children_recursive if item.library is None}
    added = set(new)
    homes = Counter(_home(item, theirs) for item in scene.objects if item.type == "MESH" and item not in added)
    usual = homes.most_common(1)[0][0] if homes else ""
    for item in new:
        home = usual if item.parent is None else _home(item.parent, theirs)
        if home and scene.collection in item.users_collection:
            bpy.data.collections[home].objects.link(item)
            scene.collection.objects.unlink(item)


def _home(item: bpy.types.Object, names: set[str]) -> str:
    """The collection of a scene that an object is in, "" for the scene's own."""
    return next((each.name for each in item.users_collection if each.name in names), "")
