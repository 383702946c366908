"""To which collection new objects go: that of the room, the active one, or their own, as the preferences say."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import bpy

from ...unisg_blender.blender.write.listing import is_own
from ..preferences import preference

OWN = "UniSG"


def put_home(context: bpy.types.Context, new: Sequence[bpy.types.Object]) -> None:
    """Move new objects to where they belong; parents come before their children."""
    scene, how = context.scene, preference("home")
    if how == "ROOM":
        put_beside(scene, new)
        return
    home = context.view_layer.active_layer_collection.collection if how == "ACTIVE" else _own(scene)
    for item in new if is_own(home) else ():
        for before in item.users_collection:  # that of a shape, if it came from the scene
            before.objects.unlink(item)
        home.objects.link(item)


def put_beside(scene: bpy.types.Scene, new: Sequence[bpy.types.Object]) -> None:
    """Move new objects from the scene's own collection to that of their parent, or of most of the scene's things.

    Objects of a scene without collections stay. Parents come before their children.
    """
    theirs = {item.name for item in scene.collection.children_recursive if is_own(item)}
    added = set(new)
    homes = Counter(_home(item, theirs) for item in scene.objects if item.type == "MESH" and item not in added)
    usual = homes.most_common(1)[0][0] if homes else ""
    for item in new:
        home = usual if item.parent is None else _home(item.parent, theirs)
        if home and scene.collection in item.users_collection:
            bpy.data.collections[home].objects.link(item)
            scene.collection.objects.unlink(item)


def _own(scene: bpy.types.Scene) -> bpy.types.Collection:
    """The collection for new objects, made where there is none."""
    for found in scene.collection.children_recursive:
        if found.name.partition(".")[0] == OWN and is_own(found):
            return found
    made = bpy.data.collections.new(OWN)
    scene.collection.children.link(made)
    return made


def _home(item: bpy.types.Object, names: set[str]) -> str:
    """The collection of a scene that an object is in, "" for the scene's own."""
    return next((each.name for each in item.users_collection if each.name in names), "")
