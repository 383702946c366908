"""Draws in the viewport what is recognised of the building; nothing is computed while it draws."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import bpy

from ..operators.room.recognised import Recognised, looking, problem, recognise_soon, recognised
from ..operators.room.structure_shapes import LEGEND, StructureShapes
from .viewport_drawing import MARGIN, DrawHandlers, shadowed_text


@dataclass
class DrawnBuilding:
    """What is drawn: of what, and a batch for each colour with its shader,
    and whether that draws lines."""

    found: Recognised | None = None
    batches: list[tuple[Any, Any, Any, bool]] = field(default_factory=list)


_drawn = DrawnBuilding()


def _prepared(context: bpy.types.Context) -> StructureShapes | None:
    """The shapes of the current scene; made once for each time that it is looked at."""
    found = recognised(context.scene)
    if not context.window_manager.unisg_structure_shown or not context.space_data.overlay.show_overlays:
        return None
    if found is None and not looking() and not problem(context.scene):
        recognise_soon(context.scene)  # another scene is shown now
    if found is not _drawn.found:
        _drawn.found, _drawn.batches = found, []
    return None if found is None else found.shapes


def _batches(shapes: StructureShapes) -> list[tuple[Any, Any, Any, bool]]:
    import gpu
    from gpu_extras.batch import batch_for_shader

    if not _drawn.batches:
        plain, thick = (gpu.shader.from_builtin(name) for name in ("UNIFORM_COLOR", "POLYLINE_UNIFORM_COLOR"))
        for shader, kind, parts in ((plain, "TRIS", shapes.triangles), (thick, "LINES", shapes.lines)):
            for colour, points in parts.items():
                batch = batch_for_shader(shader, kind, {"pos": points})
                _drawn.batches.append((shader, batch, colour, kind == "LINES"))
    return _drawn.batches


def _draw() -> None:
    context = bpy.context
    shapes = _prepared(context)
    if shapes is None:
        return
    import gpu

    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("NONE")
    for shader, batch, colour, of_lines in _batches(shapes):
        shader.bind()
        shader.uniform_float("color", colour)
        if of_lines:
            shader.uniform_float("lineWidth", 2.0 * context.preferences.system.ui_scale)
            shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
        batch.draw(shader)
    gpu.state.blend_set("NONE")


def _write() -> None:
    """Labels of the rooms, and the legend."""
    context = bpy.context
    shapes = _prepared(context)
    if shapes is None:
        return
    import blf
    from bpy_extras.view3d_utils import location_3d_to_region_2d

    with shadowed_text(context) as scale:
        for text, place in shapes.labels:
            at = location_3d_to_region_2d(context.region, context.region_data, place)
            if at is not None:
                width, height = blf.dimensions(0, text)
                blf.position(0, at.x - width / 2, at.y - height / 2, 0)
                blf.draw(0, text)
        left = max(context.region.width - blf.dimensions(0, LEGEND)[0], 0) / 2  # the redo panel is in the corner
        blf.position(0, left, MARGIN * scale, 0)
        blf.draw(0, LEGEND)


CLASSES = ()


_handlers = DrawHandlers(_draw, _write)


def register() -> None:
    """Start drawing."""
    _handlers.start()


def unregister() -> None:
    """Stop drawing, and let go of what was drawn."""
    _drawn.found, _drawn.batches = None, []
    _handlers.stop()
