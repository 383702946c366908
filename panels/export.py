"""The Dataset panel: from where, where to, in which form, and a button."""

from __future__ import annotations

import bpy

from .main import DataPanel


class UNISG_PT_dataset(DataPanel):
    """Write the open scene, or a folder of files, for training"""

    bl_label = "Dataset"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.window_manager.unisg_dataset
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(settings, "inputs", text="Files", placeholder="this file")
        layout.prop(settings, "filepath", text="Dataset")
        layout.prop(settings, "form")
        layout.prop(settings, "instances")
        layout.prop(settings, "understand")
        column = layout.column(align=True)
        column.prop(settings, "resume" if settings.inputs else "all_scenes")
        column.prop(settings, "overwrite")
        if settings.status:
            layout.progress(factor=settings.share, text=f"{settings.status}   ESC: stop")
            return
        column = layout.column()
        column.enabled = bool(settings.filepath)
        text = "Export Dataset" if settings.filepath else "Choose a folder above to export"
        button = column.operator("unisg.export_dataset", text=text, icon="EXPORT")
        for name in ("filepath", "inputs", "form", "instances", "understand", "all_scenes", "resume", "overwrite"):
            setattr(button, name, getattr(settings, name))


CLASSES = (UNISG_PT_dataset,)
