"""Bones of new armatures: Blender makes them in edit mode only."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import bpy
import mathutils
import numpy as np
from numpy.typing import NDArray

from ...runtime.read_report import ReadReport
from ...scene.components import BONES
from ...scene.graph import SceneGraph

Entry = dict[str, NDArray]


def write_bones(graph: SceneGraph, objects: Mapping[int, bpy.types.Object], report: ReadReport) -> None:
    """Give new armatures their bones and poses."""
    found = graph.components.get(BONES)
    for row, entry in () if found is None else found.groups():
        item = objects.get(row)
        if item is None or item.type != "ARMATURE":
            continue
        if not item.data.bones:
            with _edited(item):
                _make_bones(item.data, entry)
        _pose(item, entry)
        if np.any(np.linalg.norm(entry["rest"][:, :3, :3], axis=1) - 1 > 1e-4):
            report.add(item.name, "scale of bones in rest is lost")


@contextmanager
def _edited(item: bpy.types.Object) -> Iterator[None]:
    """Edit mode for one object, through the current scene; then everything is as before."""
    layer, scene = bpy.context.view_layer, bpy.context.scene
    before = layer.objects.active
    if before is not None and before.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    scene.collection.objects.link(item)
    try:
        layer.objects.active = item
        bpy.ops.object.mode_set(mode="EDIT")
        yield
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
        layer.objects.active = before
        scene.collection.objects.unlink(item)


def _make_bones(armature: bpy.types.Armature, entry: Entry) -> None:
    made: dict[str, bpy.types.EditBone] = {}
    for place, name in enumerate(entry["name"]):
        bone = armature.edit_bones.new(str(name))
        bone.head, bone.tail = (0, 0, 0), (0, float(entry["length"][place]) or 1e-3, 0)
        bone.matrix = mathutils.Matrix(entry["rest"][place])
        bone.use_deform, bone.use_relative_parent = bool(entry["deform"][place]), bool(entry["relative"][place])
        above = made.get(str(entry["parent"][place]))
        if above is not None:
            bone.parent, bone.use_connect = above, bool(entry["connected"][place])
        made[str(name)] = bone


def _pose(item: bpy.types.Object, entry: Entry) -> None:
    """Set each posed bone's own matrix: how it differs from where its parent carries its rest."""
    place = {str(name): number for number, name in enumerate(entry["name"])}
    for name, number in place.items():
        bone = item.pose.bones.get(name)
        above = place.get(str(entry["parent"][number]))
        carried = entry["rest"][number]
        if above is not None:
            if abs(np.linalg.det(entry["pose"][above])) < 1e-12:
                continue
            carried = entry["pose"][above] @ np.linalg.inv(entry["rest"][above]) @ carried
        if bone is not None and abs(np.linalg.det(carried)) > 1e-12:
            bone.matrix_basis = mathutils.Matrix(np.linalg.inv(carried) @ entry["pose"][number])
