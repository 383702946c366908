"""Prints the world matrices, in metres, that Blender itself gives for the objects of some scene files, as JSON."""

from __future__ import annotations

import contextlib
import json
import os
import sys
from collections.abc import Callable

import bpy


def importer(ending: str) -> Callable[..., set[str]]:
    """Blender's own importer of a kind of file."""
    import addon_utils  # is there once bpy is

    if ending in ("glb", "gltf", "fbx"):
        addon_utils.enable(f"io_scene_{'fbx' if ending == 'fbx' else 'gltf2'}", default_set=False)
    if ending == "fbx":
        return bpy.ops.import_scene.fbx
    if ending in ("glb", "gltf"):
        return bpy.ops.import_scene.gltf
    return bpy.ops.wm.obj_import if ending == "obj" else bpy.ops.wm.usd_import


def worlds(path: str) -> dict[str, dict[str, list[list[float]]]]:
    """World matrices of all evaluated objects by scene and name."""
    ending = path.rsplit(".", 1)[1].lower()
    if ending == "blend":
        bpy.ops.wm.open_mainfile(filepath=path, use_scripts=False, load_ui=False)
    else:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        importer(ending)(filepath=path)
    found = {}
    for scene in bpy.data.scenes:
        layer = scene.view_layers[0]
        layer.update()  # disabled objects are not evaluated: their matrix_world says nothing
        found[scene.name] = {
            item.name: in_metres(item, scene) for item in layer.depsgraph.objects if item.name in scene.objects
        }
    return found


def in_metres(item: bpy.types.Object, scene: bpy.types.Scene) -> list[list[float]]:
    """An object's world matrix."""
    settings, matrix = scene.unit_settings, item.matrix_world.copy()
    if settings.system != "NONE":
        matrix.translation *= settings.scale_length
    return [list(row) for row in matrix]


if __name__ == "__main__":
    channel = os.dup(1)
    os.dup2(2, 1)  # Blender's own words must not get into the answer
    result = {}
    for name in sys.argv[1:]:
        with contextlib.suppress(RuntimeError):
            result[name] = worlds(name)
    os.write(channel, json.dumps(result).encode())
    os._exit(0)
