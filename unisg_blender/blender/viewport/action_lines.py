"""What the viewport shows of actions: lines in the world, with colours."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np
from numpy.typing import NDArray

from ...behaviour.playing.guide_lines import Points, box_lines, cone_lines, dashes, moved, sphere_lines
from ...errors import UniSGError
from ...scene.action_data import ActionData
from ..lookup import objects_by_uid
from ..scene_units import metres_per_unit

Color = tuple[float, float, float, float]
WANTED: Color = (1.0, 0.6, 0.1, 0.9)
HOLDS: Color = (0.2, 0.9, 0.4, 0.9)
LIMIT: Color = (0.4, 0.7, 1.0, 0.6)
LINK: Color = (0.9, 0.9, 0.9, 0.5)
EDGES = 4000
"""A mesh with more edges than this is shown as its box."""

Lines = tuple[Points, Color]


def action_lines(scene: bpy.types.Scene, action: ActionData, holds: bool = False) -> Iterator[Lines]:
    """Segments (2K, 3) in the world, in the scene's unit, with their colours, for one action.

    The hologram of the reference pose, the distance and the angle within which it
    counts, and lines from the target to it, from tools to targets.
    """
    objects, units = objects_by_uid(scene), 1.0 / metres_per_unit(scene)
    targets = [objects[uid] for uid in action.targets if uid in objects]
    tools = [objects[uid] for uid in action.tools if uid in objects]
    posed = tools if action.type == "Tool" else targets
    color = HOLDS if holds else WANTED
    try:
        place = _reference(action, objects)
    except UniSGError:
        place = None
    if place is not None and posed:
        goal = _with_scale(place, np.array(posed[0].matrix_world))
        yield hologram(posed[0], goal), color
        limits = action.thresholds
        if limits.distance:
            yield sphere_lines(place[:3, 3], limits.distance * units), LIMIT
        if limits.angle:
            size = max(0.1 * units, 0.6 * float(max(posed[0].dimensions)))
            yield cone_lines(place, min(limits.angle, np.pi), size), LIMIT
        yield from ((dashes(np.array(item.matrix_world)[:3, 3], place[:3, 3]), color) for item in posed)
    elif action.type in ("Insert", "Remove", "Use", "Tool"):
        for item in targets:
            yield hologram(item, np.array(item.matrix_world)), color
    for tool in tools:
        for target in targets:
            if tool != target:
                yield dashes(np.array(tool.matrix_world)[:3, 3], np.array(target.matrix_world)[:3, 3]), LINK


def _reference(action: ActionData, objects: dict[str, bpy.types.Object]) -> NDArray[np.float64] | None:
    if action.reference_matrix is None:
        return None
    if action.frame and action.frame not in objects:
        raise UniSGError("the frame is not in the scene")
    frame = np.array(objects[action.frame].matrix_world) if action.frame else np.eye(4)
    return frame @ action.reference_matrix


def _with_scale(place: NDArray[np.float64], own: NDArray[np.float64]) -> NDArray[np.float64]:
    """The place with the size that the object has now."""
    goal = place.copy()
    sizes = np.linalg.norm(own[:3, :3], axis=0) / np.maximum(np.linalg.norm(place[:3, :3], axis=0), 1e-12)
    goal[:3, :3] *= sizes
    return goal


def hologram(item: bpy.types.Object, matrix: NDArray[np.float64]) -> Points:
    """An object's edges at another world matrix (4, 4); its box if it has many, that of all below it if it has none."""
    if item.type == "MESH" and 0 < len(item.data.edges) <= EDGES and item.mode == "OBJECT":
        points = np.empty(3 * len(item.data.vertices), np.float32)
        pairs = np.empty(2 * len(item.data.edges), np.int32)
        item.data.vertices.foreach_get("co", points)
        item.data.edges.foreach_get("vertices", pairs)
        return moved(points.reshape(-1, 3)[pairs].astype(np.float64), matrix)
    back = np.linalg.pinv(np.array(item.matrix_world))
    corners = [
        moved(np.array(each.bound_box), back @ np.array(each.matrix_world))
        for each in (item, *item.children_recursive)
        if each.type not in ("EMPTY", "CAMERA", "LIGHT", "ARMATURE")
    ]
    points = np.concatenate(corners) if corners else np.array([[-0.05] * 3, [0.05] * 3])
    return box_lines(points.min(axis=0), points.max(axis=0), matrix)
