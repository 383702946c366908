"""Draws in the viewport what is being placed: the heat of likely places, the ghost, and in words what is wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ..operators.placing.placing_session import Placing, placing
from ..operators.preferences import preference
from .viewport_drawing import MARGIN, TEXT, DrawHandlers, shadowed_text

SOLID = 0.8
"""Opacity of the ghost, whose colour says whether it fits; the words beside it say the same."""

FAINT, STRONG = 0.16, 0.72
"""Opacity of the least and of the most likely places."""

LIGHT, DARK = np.array([0.36, 0.48, 0.8]), 0.45
"""Where the ghost's light comes from, and how bright it is in the shade."""

OFF = 0.006
"""Metres that the heat lies before its surface."""

BAR = 90
"""How long the bar of the legend is, pixels."""


@dataclass
class DrawnPlacing:
    """What is drawn: of which room, and with their shaders a batch for the heat, and for the ghost two: fine, wrong."""

    room: object = None
    heat: tuple[Any, Any] | None = None
    shape: tuple[Any, list[Any]] | None = None


_drawn = DrawnPlacing()


def _colour(name: str) -> Any:
    """A colour of the preferences."""
    return np.array(preference(name), np.float32)


def heat_colours(heat: Any) -> Any:
    """Colours with opacity (N, 4) of heat (N,) from 0 to 1: those of the preferences, stronger and stronger."""
    cold, warm, hot = (_colour(name) for name in ("cold", "warm", "hot"))
    share = np.asarray(heat, np.float32)[:, None]
    low, high = np.minimum(2 * share, 1), np.maximum(2 * share - 1, 0)
    colour = cold + (warm - cold) * low + (hot - warm) * high
    return np.column_stack([colour, FAINT + (STRONG - FAINT) * share]).astype(np.float32)


def shading(triangles: Any) -> Any:
    """How bright triangles (M, 3, 3) are, 0 to 1, under a light from above and aside."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    return DARK + (1 - DARK) * np.abs(normal @ LIGHT) / length


def _current(context: bpy.types.Context) -> Placing | None:
    """What is placed in the scene that is shown."""
    current = placing()
    return current if current is not None and current.scene == context.scene.name else None


def _prepare(current: Placing) -> None:
    """Make the batches once for each room."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    room = current.room
    if room is _drawn.room:
        return
    _drawn.room, _drawn.heat, _drawn.shape = room, None, None
    if room is None:
        return
    shown = np.flatnonzero((room.map.heat > 0) & (np.ptp(room.map.cells.corners, axis=1).max(axis=1) > 0))
    if len(shown):
        corners = room.map.cells.corners[shown] + OFF * room.map.cells.normal[shown, None]
        points = (corners / current.metres).astype(np.float32)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
        shader = gpu.shader.from_builtin("SMOOTH_COLOR")
        colours = np.repeat(heat_colours(room.map.heat[shown]), 6, axis=0)
        _drawn.heat = shader, batch_for_shader(shader, "TRIS", {"pos": points, "color": colours})
    if len(room.triangles):
        shader = gpu.shader.from_builtin("SMOOTH_COLOR")
        points = (room.triangles / current.metres).astype(np.float32).reshape(-1, 3)
        shade = np.repeat(shading(room.triangles), 3)[:, None]
        batches = []
        for name in ("fits", "wrong"):
            colours = np.column_stack([shade * _colour(name), np.full(len(points), SOLID)]).astype(np.float32)
            batches.append(batch_for_shader(shader, "TRIS", {"pos": points, "color": colours}))
        _drawn.shape = shader, batches


def _draw() -> None:
    current = _current(bpy.context)
    if current is None:
        _drawn.room = _drawn.heat = _drawn.shape = None
        return
    import gpu
    import mathutils

    _prepare(current)
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    if _drawn.heat is not None:
        shader, batch = _drawn.heat
        batch.draw(shader)
    if _drawn.shape is not None and current.room is not None and current.ghost is not None:
        shader, batches = _drawn.shape
        batch = batches[bool(current.ghost.wrong)]
        motion = current.room.target.placeable.motion(current.ghost.place)
        motion[:3, 3] /= current.metres
        with gpu.matrix.push_pop():
            gpu.matrix.multiply_matrix(mathutils.Matrix(motion.tolist()))
            gpu.state.depth_mask_set(True)
            for seen in (False, True):  # first its depth alone: what is behind in it must not shine through
                gpu.state.color_mask_set(seen, seen, seen, seen)
                batch.draw(shader)
            gpu.state.depth_mask_set(False)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def _write() -> None:
    """The words beside the ghost, and the legend."""
    context = bpy.context
    current = _current(context)
    if current is None:
        return
    import blf

    mine = context.region.as_pointer() == current.region  # not in the other viewports
    with shadowed_text(context) as scale:
        for number, line in enumerate(current.lines() if mine else ()):
            left, low = current.mouse[0] + 24 * scale, current.mouse[1] - (18 + 18 * number) * scale
            width, height = blf.dimensions(0, line)
            _box(left - 6 * scale, low - 5 * scale, width + 12 * scale, height + 10 * scale)
            blf.position(0, left, low, 0)
            blf.draw(0, line)
        if current.room is not None:
            _legend(context, current, scale)


def _legend(context: bpy.types.Context, current: Placing, scale: float) -> None:
    """One line: where the model would put it, from unlikely to likely."""
    import blf

    assert current.room is not None
    free = bool(current.room.map.fits.any())
    first = f"{current.room.wanted.category}: where the model would put it    unlikely "
    last = " likely    not coloured: no room for it"
    if not free:
        first, last = f"{current.room.wanted.category}: no free place {current.room.note}", ""
    bar = BAR * scale * free
    width = blf.dimensions(0, first)[0] + bar + blf.dimensions(0, last)[0]
    left, low = max(context.region.width - width, 0) / 2, MARGIN * scale
    blf.position(0, left, low, 0)
    blf.draw(0, first)
    left += blf.dimensions(0, first)[0]
    if free:
        _bar(left, low, bar, TEXT * scale)
        blf.position(0, left + bar, low, 0)
        blf.draw(0, last)


def _bar(left: float, low: float, width: float, height: float) -> None:
    """The colours from unlikely to likely, side by side."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    ends = np.linspace(left, left + width, 9)
    points = [(x, y) for x in ends for y in (low, low + height)]
    colours = np.repeat(heat_colours(np.linspace(0, 1, 9)), 2, axis=0)
    colours[:, 3] = 1.0
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    batch_for_shader(shader, "TRI_STRIP", {"pos": points, "color": colours}).draw(shader)


def _box(left: float, low: float, width: float, height: float) -> None:
    """A dark ground for words."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    points = [(left, low), (left + width, low), (left, low + height), (left + width, low + height)]
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    gpu.state.blend_set("ALPHA")
    shader.bind()
    shader.uniform_float("color", (0.05, 0.05, 0.05, 0.75))
    batch_for_shader(shader, "TRI_STRIP", {"pos": points}).draw(shader)
    gpu.state.blend_set("NONE")


CLASSES = ()


_handlers = DrawHandlers(_draw, _write)


def register() -> None:
    """Start drawing."""
    _handlers.start()


def unregister() -> None:
    """Stop drawing, and let go of what was drawn."""
    _drawn.room = _drawn.heat = _drawn.shape = None
    _handlers.stop()
