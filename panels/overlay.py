"""Draws in the viewport what actions ask for: the active object's active one, or what a played lesson waits for."""

from __future__ import annotations

from typing import Any

import bpy

from ..operators.action_properties import active_action
from ..operators.play import session
from .main import SidebarPanel

_handles: list[Any] = []


class UNISG_PT_overlay(SidebarPanel, bpy.types.Panel):
    """Whether the viewport shows it."""

    bl_label = "Show in Viewport"
    bl_parent_id = "UNISG_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.prop(context.window_manager, "unisg_overlay")


def _shown(context: bpy.types.Context) -> list[tuple[Any, bool]]:
    current = session()
    if current is not None:
        return [pair for pair in current.open_actions() if pair[0].type not in ("Question", "Parallel")]
    item = context.active_object
    action = active_action(context, item) if item is not None else None
    return [(action, False)] if action is not None else []


def _draw() -> None:
    context = bpy.context
    if not context.window_manager.unisg_overlay or not context.space_data.overlay.show_overlays:
        return
    shown = _shown(context)
    if not shown:
        return
    import gpu
    from gpu_extras.batch import batch_for_shader

    from ..unisg_blender.blender.overlay import action_lines

    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.bind()
    shader.uniform_float("lineWidth", 1.5 * context.preferences.system.ui_scale)
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("NONE")
    for action, holds in shown:
        for points, color in action_lines(context.scene, action, holds):
            shader.uniform_float("color", color)
            batch_for_shader(shader, "LINES", {"pos": points.astype("float32")}).draw(shader)
    gpu.state.blend_set("NONE")


CLASSES = (UNISG_PT_overlay,)


def register() -> None:
    """Start drawing."""
    bpy.types.WindowManager.unisg_overlay = bpy.props.BoolProperty(
        name="What Actions Ask For", default=True, options={"SKIP_SAVE"},
        description="Reference poses, tolerances and links of the active action, or of those a played lesson waits for",
    )  # fmt: skip
    if not bpy.app.background:
        _handles.append(bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW"))


def unregister() -> None:
    """Stop drawing."""
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    del bpy.types.WindowManager.unisg_overlay
