"""The form microscope: paths between two keyed poses, drawn in the 3D viewport.

``start`` adds the draw handlers and ``stop`` removes them; nothing stays behind.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ...poses import FORMS
from ...poses.paths import PATH_NAMES, compare_paths
from ..fcurves import Floats, Item
from ..motion.keyframes import animated, key_times, plain, read_motors

COLOURS = dict(
    zip(PATH_NAMES, ((0.95, 0.35, 0.3), (0.35, 0.65, 1.0), (0.6, 0.6, 0.65), (0.35, 0.9, 0.45)), strict=True)
)
POSES, EVERY = 65, 8  # poses on a path, and which of them show their axes
AXES = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]])

_handlers: list[Any] = []


@dataclass(frozen=True)
class DrawnPath:
    """World-space lines of one path: ``points`` (P, 3), ``axes`` (A, 3) in pairs of ends, its name's place."""

    name: str
    points: Floats
    axes: Floats

    @property
    def label(self) -> Floats:
        """Where the name stands: the middle of the path."""
        return self.points[len(self.points) // 2]


def drawn_paths(item: Item, frame: float, spread: float) -> list[DrawnPath]:
    """Paths between the two keyed poses around a frame.

    Parameters
    ----------
    item
        Object or pose bone; with fewer than two keyed frames there are no paths.
    frame
        The current frame.
    spread
        How far apart the paths stand, in lengths of the motion; 0 lays them over each other.

    Returns
    -------
    list of DrawnPath
        One per name in ``PATH_NAMES``, or none.
    """
    if not animated(item) or not plain(item) or len(times := key_times(item)) < 2:
        return []
    span = int(np.clip(np.searchsorted(times, frame, side="right") - 1, 0, len(times) - 2))
    ends = FORMS["dual_quaternion"].decode(read_motors(item, times[span : span + 2]))
    ends = _space(item) @ ends @ np.diag([*item.scale, 1.0])
    paths = compare_paths(ends[0], ends[1], POSES)
    places = np.concatenate([path[:, :3, 3] for path in paths.values()])
    extent = float(np.ptp(places, axis=0).max()) or 1.0
    size = 0.12 * extent / (np.linalg.norm(ends[:, :3, :3], axis=(1, 2)).max() or 1.0)
    return [
        _drawn(name, path, size, np.array([0.0, 0.0, n * spread * extent]))
        for n, (name, path) in enumerate(paths.items())
    ]


def start() -> None:
    """Begin drawing in all 3D viewports."""
    if not _handlers:
        view = bpy.types.SpaceView3D
        _handlers.append(view.draw_handler_add(_draw_lines, (), "WINDOW", "POST_VIEW"))
        _handlers.append(view.draw_handler_add(_draw_names, (), "WINDOW", "POST_PIXEL"))


def stop() -> None:
    """End drawing."""
    while _handlers:
        bpy.types.SpaceView3D.draw_handler_remove(_handlers.pop(), "WINDOW")


def running() -> bool:
    """Whether the paths are being drawn."""
    return bool(_handlers)


def _space(item: Item) -> Floats:
    """World matrix of the space in which the item's own channels live."""
    if isinstance(item, bpy.types.PoseBone):
        return np.array(item.id_data.matrix_world @ item.matrix @ item.matrix_basis.inverted_safe())
    return np.array(item.matrix_world @ item.matrix_basis.inverted_safe())


def _drawn(name: str, path: Floats, size: float, offset: Floats) -> DrawnPath:
    points = path[:, :3, 3] + offset
    shown = path[::EVERY]
    tips = shown[:, :3, 3][:, None] + size * np.einsum("pij,aj->pai", shown[:, :3, :3], AXES)
    origins = np.broadcast_to(shown[:, None, :3, 3], tips.shape)
    return DrawnPath(name, points, np.stack([origins, tips], axis=2).reshape(-1, 3) + offset)


def _current() -> list[DrawnPath]:
    context = bpy.context
    item = context.active_pose_bone if context.mode == "POSE" else context.active_object
    if item is None:
        return []
    return drawn_paths(item, context.scene.frame_current_final, context.window_manager.unisg_microscope.spread)


def _draw_lines() -> None:
    import gpu
    from gpu_extras.batch import batch_for_shader

    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    gpu.state.blend_set("ALPHA")
    for path in _current():
        for kind, lines, width, alpha in (("LINE_STRIP", path.points, 2.5, 1.0), ("LINES", path.axes, 1.5, 0.6)):
            shader.uniform_float("lineWidth", width)
            shader.uniform_float("color", (*COLOURS[path.name], alpha))
            batch_for_shader(shader, kind, {"pos": lines.astype(np.float32).tolist()}).draw(shader)
    gpu.state.blend_set("NONE")


def _draw_names() -> None:
    import blf
    from bpy_extras.view3d_utils import location_3d_to_region_2d

    for path in _current():
        place = location_3d_to_region_2d(bpy.context.region, bpy.context.region_data, path.label)
        if place is not None:
            blf.size(0, 13)
            blf.color(0, *COLOURS[path.name], 1.0)
            blf.position(0, place.x + 8, place.y + 8, 0)
            blf.draw(0, path.name)
