"""Parents and matrices of new objects."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import bpy
import mathutils
import numpy as np
from numpy.typing import NDArray

from ...runtime.read_report import ReadReport
from ...scene.components import CHANNELS, PARENTING, WORLD
from ...scene.graph import SceneGraph
from ...scene.hierarchy import world_matrices
from ..helper_objects import new_helper
from ..trs import differ, split
from .component_entries import Objects, entries

SAME = 1e-6  # channels spell a matrix if they agree with it to this, relative


def place_objects(
    graph: SceneGraph, objects: Objects, standing: Objects, report: ReadReport
) -> list[tuple[bpy.types.Object, bpy.types.Object]]:
    """Set parent, parent inverse, location, rotation and scale of new objects.

    What location, rotation and scale cannot say (shear) goes into the parent
    inverse; a root, which has none, gets a helper for a parent.

    Returns
    -------
    list
        (helper, the object it belongs to), for linking.
    """
    helpers = []
    rows = np.array(list(objects), np.int64)
    local = _reachable_locals(graph, rows, report)
    hung = _hang(graph, objects, standing, local, report)
    inner = np.array([np.linalg.inv(hung[row]) @ local[row] if row in hung else local[row] for row in objects])
    channels = split(inner.reshape(-1, 4, 4))
    spelled = _spell(graph, objects, dict(zip(objects, inner, strict=True)))
    for place, (row, item) in enumerate(objects.items()):
        if row in spelled:
            continue
        if channels.sheared[place]:
            if item.parent is None:
                helpers.append((new_helper(f"{item.name} frame"), item))
                item.parent = helpers[-1][0]
            item.matrix_parent_inverse = mathutils.Matrix(inner[place])
            continue
        item.location, item.rotation_euler = channels.location[place], channels.euler[place]
        item.scale = channels.scale[place]
    return helpers


def _reachable_locals(graph: SceneGraph, rows: NDArray[np.int64], report: ReadReport) -> dict[int, NDArray[np.float64]]:
    """Local matrices by row; those that constraints moved in the scene that was read stand where they stood."""
    local = {int(row): graph.local[row] for row in rows}
    moved = graph.components.get(WORLD)
    if moved is None:
        return local
    world = world_matrices(graph)
    for row in moved.rows:
        above = graph.parent[row]
        if int(row) not in local:
            continue
        report.add(graph.name[row], "stands where constraints put it, without the constraints")
        if above < 0:
            local[int(row)] = world[row]
        elif abs(np.linalg.det(world[above])) > 0:
            local[int(row)] = np.linalg.inv(world[above]) @ world[row]
    return local


def _hang(
    graph: SceneGraph,
    objects: Objects,
    standing: Objects,
    local: Mapping[int, NDArray[np.float64]],
    report: ReadReport,
) -> dict[int, NDArray[np.float64]]:
    """Set the parents; frames of the bones or vertices on which some objects hang, by row."""
    for row, item in objects.items():
        above = int(graph.parent[row])
        if above >= 0:
            item.parent = objects[above] if above in objects else standing[above]
    frames: dict[int, NDArray[np.float64]] = {}
    for row, item, entry in entries(graph, PARENTING, objects):
        if item.parent is None:
            continue
        part = abs(np.linalg.det(entry["frame"])) >= 1e-12 and _has_part(item.parent, entry)
        if not part or not _takes_kind(item, str(entry["kind"])):
            report.add(item.name, "hangs on its parent as a whole, not on a bone or vertex")
            continue
        item.parent_bone = str(entry["bone"])
        if item.parent_type.startswith("VERTEX"):
            item.parent_vertices = entry["vertices"].tolist()
        frames[row] = entry["frame"]
    return frames


def _has_part(parent: bpy.types.Object, entry: Mapping[str, Any]) -> bool:
    if entry["kind"] == "BONE":
        return parent.type == "ARMATURE" and str(entry["bone"]) in parent.data.bones
    if entry["kind"].startswith("VERTEX"):
        return parent.type == "MESH" and int(entry["vertices"].max()) < len(parent.data.vertices)
    return True


def _takes_kind(item: bpy.types.Object, kind: str) -> bool:
    """Set how an object hangs on its parent; False where Blender knows no such way for that parent."""
    try:
        item.parent_type = kind
    except TypeError:
        return False
    return True


def _spell(graph: SceneGraph, objects: Objects, inner: Mapping[int, NDArray[np.float64]]) -> set[int]:
    """Set the channels as they were read, where they still say the local matrix; rows that are done."""
    done = set()
    for row, item, entry in entries(graph, CHANNELS, objects):
        before = item.rotation_mode
        set_channels(item, entry)
        said = np.array(item.matrix_basis, np.float64)
        if item.parent is not None:
            item.matrix_parent_inverse = mathutils.Matrix(entry["inverse"])
            said = entry["inverse"] @ said
        if differ(said[None], inner[row][None], SAME)[0]:
            clear_channels(item, before)
        else:
            done.add(row)
    return done


def set_channels(item: bpy.types.Object, entry: Mapping[str, NDArray]) -> None:
    """Location, rotation in its mode, scale, and their deltas."""
    mode = str(entry["mode"])
    item.rotation_mode = mode
    item.location, item.scale = entry["location"], entry["scale"]
    item.delta_location, item.delta_scale = entry["delta_location"], entry["delta_scale"]
    if mode == "QUATERNION":
        item.rotation_quaternion, item.delta_rotation_quaternion = entry["rotation"], entry["delta_rotation"]
    elif mode == "AXIS_ANGLE":
        item.rotation_axis_angle = entry["rotation"]
        item.delta_rotation_euler = entry["delta_rotation"][:3]
    else:
        item.rotation_euler, item.delta_rotation_euler = entry["rotation"][:3], entry["delta_rotation"][:3]


def clear_channels(item: bpy.types.Object, mode: str) -> None:
    """Back to a fresh object's channels."""
    item.rotation_mode = mode
    item.delta_location, item.delta_scale = (0, 0, 0), (1, 1, 1)
    item.delta_rotation_euler, item.delta_rotation_quaternion = (0, 0, 0), (1, 0, 0, 0)
    item.matrix_parent_inverse = mathutils.Matrix.Identity(4)
