"""What Blender evaluates: the view layer that is read, its depsgraph, and which objects are in it."""

from __future__ import annotations

import bpy


def updated_depsgraph(scene: bpy.types.Scene) -> tuple[bpy.types.ViewLayer, bpy.types.Depsgraph]:
    """The view layer that is read, the current or the first one, and its depsgraph, evaluated."""
    if scene == bpy.context.scene:
        return bpy.context.view_layer, bpy.context.evaluated_depsgraph_get()
    layer = scene.view_layers[0]
    layer.update()
    return layer, layer.depsgraph


def is_evaluated(item: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """False for objects that Blender leaves out: disabled in the viewport, or in an excluded collection."""
    return bool(item.evaluated_get(depsgraph).is_evaluated)
