"""Sampled motion as keyframes."""

from __future__ import annotations

import bpy
import mathutils
import numpy as np
from numpy.typing import NDArray

from ...runtime.read_report import ReadReport
from ...scene.components import ANIMATION, PARENTING
from ...scene.graph import SceneGraph
from ..fcurves import continuous_signs, new_curves
from ..scene_frames import frame_rate
from ..trs import split
from .component_entries import Objects, entries


def write_animation(
    graph: SceneGraph,
    objects: Objects,
    scene: bpy.types.Scene,
    report: ReadReport,
) -> None:
    """Keyframes for the sampled motion of objects; rotations become quaternions that never jump."""
    rate = frame_rate(scene)
    parts = graph.components.get(PARENTING)
    for row, item, entry in entries(graph, ANIMATION, objects):
        above = np.eye(4)
        if parts is not None and item.parent_type != "OBJECT" and row in parts.rows:
            above = parts.of(row)["frame"][0]
        if item.parent is not None:
            above = above @ np.array(item.matrix_parent_inverse, np.float64)
        if abs(np.linalg.det(above)) < 1e-12:
            report.add(item.name, "its motion is lost: what it hangs on has no size")
            continue
        inner = np.linalg.inv(above) @ entry["matrices"]
        if _key(item, entry["times"] * rate, inner):
            report.add(item.name, "shear in its motion is lost")


def _key(item: bpy.types.Object, frames: NDArray[np.float64], matrices: NDArray[np.float64]) -> bool:
    """Set linear keyframes; returns whether some matrix has shear, which they cannot say."""
    channels = split(matrices)
    turns: NDArray[np.float64] = np.array([mathutils.Euler(angles).to_quaternion() for angles in channels.euler])
    turns = continuous_signs(turns, turns[0])
    item.rotation_mode = "QUATERNION"
    item.delta_location, item.delta_scale, item.delta_rotation_quaternion = (0, 0, 0), (1, 1, 1), (1, 0, 0, 0)
    curves = new_curves(item)
    for path, values in (("location", channels.location), ("rotation_quaternion", turns), ("scale", channels.scale)):
        for index in range(values.shape[1]):
            curve = curves.new(data_path=path, index=index)
            curve.keyframe_points.add(len(frames))
            points = np.stack([frames, values[:, index]], axis=1).astype(np.float32)
            curve.keyframe_points.foreach_set("co", points.ravel())
            curve.keyframe_points.foreach_set("interpolation", np.full(len(frames), 1, np.uint8))  # linear
            curve.update()
    return bool(channels.sheared.any())
