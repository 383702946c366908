"""The Dataset panel: where to, in which form, and a button."""

from __future__ import annotations

import bpy

from .main import SidebarPanel


class UNISG_PT_dataset(SidebarPanel, bpy.types.Panel):
    """Write the open scene for training"""

    bl_idname = "UNISG_PT_dataset"
    bl_label = "Dataset"
    bl_parent_id = "UNISG_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.window_manager.unisg_dataset
        layout.prop(settings, "filepath")
        layout.prop(settings, "form")
        row = layout.row()
        row.prop(settings, "all_scenes")
        row.prop(settings, "overwrite")
        column = layout.column()
        column.enabled = bool(settings.filepath)
        text = "Export Dataset" if settings.filepath else "Choose a folder above to export"
        button = column.operator("unisg.export_dataset", text=text, icon="EXPORT")
        for name in ("filepath", "form", "all_scenes", "overwrite"):
            setattr(button, name, getattr(settings, name))


CLASSES = (UNISG_PT_dataset,)
