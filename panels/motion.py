"""Sub-panel "Motion": screw interpolation, keyframe reduction, the form microscope."""

from __future__ import annotations

import bpy

from .main import DataPanel


class UNISG_PT_motion(DataPanel):
    """Interpolate, reduce and look at keyed motion"""

    bl_label = "Motion"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        column.operator("unisg.interpolate_motors", icon="IPO_LINEAR")
        column.operator("unisg.reduce_keyframes", icon="MOD_DECIM")
        settings = context.window_manager.unisg_microscope
        column = self.layout.column()
        column.prop(settings, "show", icon="VIEWZOOM", toggle=True)
        row = column.row()
        row.active = settings.show
        row.prop(settings, "spread")


CLASSES = (UNISG_PT_motion,)
