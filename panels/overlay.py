"""Draws in the viewport what actions ask for: the active object's active one, or what a played lesson waits for."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import bpy
from bpy.app.handlers import persistent

from ..operators.action_properties import active_action
from ..operators.base import redraw_views
from ..operators.play import session
from .main import LessonPanel
from .viewport_drawing import DrawHandlers


@dataclass
class Drawn:
    """What was drawn last: the actions shown, whether anything has moved since, batches with their colours."""

    key: list[tuple[str, Any, bool]] = field(default_factory=list)
    stale: bool = True
    batches: list[tuple[Any, Any]] = field(default_factory=list)


_drawn = Drawn()


class UNISG_PT_overlay(LessonPanel):
    """Whether the viewport shows it."""

    bl_options = {"DEFAULT_CLOSED"}

    bl_label = "Show in Viewport"

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.prop(context.window_manager, "unisg_overlay")


def _shown(context: bpy.types.Context) -> list[tuple[Any, bool]]:
    current = session()
    if current is not None:
        return [pair for pair in current.open_actions() if pair[0].type not in ("Question", "Parallel")]
    item = context.active_object
    action = active_action(context, item) if item is not None else None
    return [(action, False)] if action is not None else []


def _batches(context: bpy.types.Context, shader: Any) -> list[tuple[Any, Any]]:
    """What is drawn, one batch per colour; made again only when something moved or something else is shown."""
    shown = _shown(context)
    key = [(context.scene.name, action, holds) for action, holds in shown]
    same = len(key) == len(_drawn.key) and all(
        old[0] == new[0] and old[1] is new[1] and old[2] == new[2] for old, new in zip(_drawn.key, key, strict=True)
    )
    if not same or _drawn.stale:
        _drawn.key, _drawn.stale, _drawn.batches = key, False, _made(context, shown, shader)
    return _drawn.batches


def _made(context: bpy.types.Context, shown: list[tuple[Any, bool]], shader: Any) -> list[tuple[Any, Any]]:
    import numpy as np
    from gpu_extras.batch import batch_for_shader

    from ..unisg_blender.blender.viewport.action_lines import action_lines

    lines: dict[Any, list[Any]] = {}
    for action, holds in shown:
        for points, color in action_lines(context.scene, action, holds):
            lines.setdefault(color, []).append(points)
    return [
        (batch_for_shader(shader, "LINES", {"pos": np.concatenate(parts).astype(np.float32)}), color)
        for color, parts in lines.items()
    ]


@persistent
def _moved(*_: object) -> None:
    _drawn.stale = True


@persistent
def _loaded(*_: object) -> None:
    _drawn.key, _drawn.batches = [], []


def _draw() -> None:
    context = bpy.context
    if not context.window_manager.unisg_overlay or not context.space_data.overlay.show_overlays:
        return
    import gpu

    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    batches = _batches(context, shader)
    if not batches:
        return
    shader.bind()
    shader.uniform_float("lineWidth", 1.5 * context.preferences.system.ui_scale)
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("NONE")
    for batch, color in batches:
        shader.uniform_float("color", color)
        batch.draw(shader)
    gpu.state.blend_set("NONE")


HANDLERS = (
    ("depsgraph_update_post", _moved), ("frame_change_post", _moved), ("undo_post", _moved), ("redo_post", _moved),
    ("load_post", _loaded),
)  # fmt: skip
CLASSES = (UNISG_PT_overlay,)
PROPERTIES = (
    (bpy.types.WindowManager, "unisg_overlay", bpy.props.BoolProperty(
        name="What Actions Ask For", default=True, options={"SKIP_SAVE"},
        update=lambda manager, context: redraw_views(context),
        description="Reference poses, tolerances and links of the active action, or of those a played lesson waits for",
    )),
)  # fmt: skip


_handlers = DrawHandlers(_draw)


def register() -> None:
    """Start drawing."""
    _handlers.start()


def unregister() -> None:
    """Stop drawing."""
    _loaded()
    _handlers.stop()
