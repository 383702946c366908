"""The box "UniSG lesson" among the settings of Blender's glTF exporter."""

from __future__ import annotations

import bpy

from ..operators.interchange.gltf_lesson import WANTED, left_out, not_carried
from ..operators.scene_lookup import looked_up
from .main import draw_text


def draw_box(context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
    """Whether the lesson goes with it, and what of it cannot: before anything is written."""
    header, body = layout.panel("UNISG_gltf_lesson", default_closed=False)
    header.use_property_split = False
    header.prop(context.window_manager, WANTED)
    if body is None:
        return
    body.active = getattr(context.window_manager, WANTED)
    if not looked_up(context.scene).lessons:
        body.label(text="The scene has no lesson", icon="INFO")
        return
    exporter = getattr(context.space_data, "active_operator", None)
    lines = [*left_out(context.scene, exporter), *not_carried(context.scene)]
    body.label(text="Not carried, or told otherwise:" if lines else "All of it is carried", icon="INFO")
    for line in lines:
        draw_text(body, line, context.region.width)
