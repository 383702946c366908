"""Sub-panel "Shapes": where each category's shapes come from, and what the user chose for it."""

from __future__ import annotations

import bpy

from ..operators.shapes.library_index import libraries
from ..operators.shapes.shape_sources import CHOSEN, FILE, LIBRARY, MODEL, SCENE, ShapeSource, file_assets, source_of
from .main import ClosedPanel

ICONS = {
    CHOSEN: "PINNED",
    FILE: "ASSET_MANAGER",
    LIBRARY: "LIBRARY_DATA_DIRECT",
    SCENE: "SCENE_DATA",
    MODEL: "NETWORK_DRIVE",
}


class UNISG_PT_shapes(ClosedPanel):
    """Where the shapes of what is wanted come from: chosen, assets of this file and of libraries, scene, model"""

    bl_label = "Shapes"

    def draw(self, context: bpy.types.Context) -> None:
        layout, scene, settings = self.layout, context.scene, context.window_manager.unisg
        names = list(settings.wanted())
        if settings.active < len(settings.counts):
            names.append(settings.counts[settings.active].name)
        names += scene.unisg_shapes.keys()
        marked = file_assets()
        for name in dict.fromkeys(names):
            _category(layout.column(align=True), scene, name, source_of(scene, name, marked))
        if not names:
            layout.label(text="Set a count to see where its shape comes from", icon="INFO")
        if libraries():
            layout.operator("unisg.look_through_libraries", icon="FILE_REFRESH")
        else:
            layout.label(text="The preferences have no asset library", icon="INFO")


def _category(column: bpy.types.UILayout, scene: bpy.types.Scene, name: str, source: ShapeSource) -> None:
    """Where one category's shapes come from, and what may be chosen."""
    chosen = scene.unisg_shapes.get(name)
    row = column.row(align=True)
    row.label(text=f"{name}: {source.text}", icon=ICONS[source.kind])
    button = row.operator("unisg.choose_shape", text="", icon="ADD" if chosen is None else "X")
    button.category, button.remove = name, chosen is not None
    if chosen is not None:
        column.prop(chosen, "object", text="")
        column.prop(chosen, "collection", text="")


CLASSES = (UNISG_PT_shapes,)
