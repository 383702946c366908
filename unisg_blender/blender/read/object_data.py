"""What cameras, lights, armatures and empties are: their object data as component tables."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ...scene.component_table import Table, table
from ..data_fields import ABSENT, BLENDER_NAME, CAMERA_NUMBERS, FOCUS, LIGHT_NUMBERS, LIGHT_SWITCHES

Items = Sequence[bpy.types.Object]


def camera_table(items: Items, view_layer: bpy.types.ViewLayer) -> Table:
    """Cameras."""
    rows = [row for row, item in enumerate(items) if item.type == "CAMERA"]
    cameras = [items[row].data for row in rows]
    scene = view_layer.id_data
    return table(
        rows,
        data=[camera.name for camera in cameras],
        kind=[camera.type for camera in cameras],
        active=np.array([items[row] == scene.camera for row in rows], bool),
        fit=[camera.sensor_fit for camera in cameras],
        focused=np.array([camera.dof.use_dof for camera in cameras], bool),
        **{
            name: np.array([getattr(camera.dof, FOCUS[name]) for camera in cameras], np.float64)
            for name in ("focus_distance", "fstop")
        },
        **{name: np.array([getattr(camera, name) for camera in cameras], np.float64) for name in CAMERA_NUMBERS},
    )


def light_table(items: Items) -> Table:
    """Lights."""
    rows = [row for row, item in enumerate(items) if item.type == "LIGHT"]
    lights = [items[row].data for row in rows]
    values = {
        name: [getattr(light, BLENDER_NAME.get(name, name), ABSENT.get(name, 0)) for light in lights]
        for name in (*LIGHT_NUMBERS, *LIGHT_SWITCHES)
    }
    return table(
        rows,
        data=[light.name for light in lights],
        kind=[light.type for light in lights],
        color=np.array([tuple(light.color) for light in lights], np.float64).reshape(-1, 3),
        shape=[getattr(light, "shape", "") for light in lights],
        **{name: np.array(values[name], np.float64) for name in LIGHT_NUMBERS},
        **{name: np.array(values[name], bool) for name in LIGHT_SWITCHES},
    )


def bone_table(items: Items, depsgraph: bpy.types.Depsgraph) -> Table:
    """The bones of all armatures, posed as evaluated; Blender lists parents first."""
    found = [(row, bone) for row, item in enumerate(items) if item.type == "ARMATURE" for bone in item.data.bones]
    poses = {row: items[row].evaluated_get(depsgraph).pose for row, _ in found}
    posed = [poses[row].bones.get(bone.name) if poses[row] else None for row, bone in found]
    return table(
        [row for row, _ in found],
        name=[bone.name for _, bone in found],
        parent=[bone.parent.name if bone.parent else "" for _, bone in found],
        rest=np.array([bone.matrix_local for _, bone in found], np.float64).reshape(-1, 4, 4),
        pose=np.array(
            [bone.matrix_local if pose is None else pose.matrix for (_, bone), pose in zip(found, posed, strict=True)],
            np.float64,
        ).reshape(-1, 4, 4),
        length=np.array([bone.length for _, bone in found], np.float64),
        connected=np.array([bone.use_connect for _, bone in found], bool),
        deform=np.array([bone.use_deform for _, bone in found], bool),
        relative=np.array([bone.use_relative_parent for _, bone in found], bool),
    )


def empty_table(items: Items) -> Table:
    """Empties that are not drawn as plain axes of size 1."""
    rows = [
        row
        for row, item in enumerate(items)
        if item.type == "EMPTY" and (item.empty_display_type != "PLAIN_AXES" or item.empty_display_size != 1.0)
    ]
    return table(
        rows,
        display=[items[row].empty_display_type for row in rows],
        size=np.array([items[row].empty_display_size for row in rows], np.float64),
    )
