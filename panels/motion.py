"""Sub-panel "Motion": screw interpolation, keyframe reduction, the form microscope."""

from __future__ import annotations

import bpy

from .main import SidebarPanel


class UNISG_PT_motion(SidebarPanel, bpy.types.Panel):
    """Interpolate, reduce and look at keyed motion"""

    bl_idname = "UNISG_PT_motion"
    bl_label = "Motion"
    bl_parent_id = "UNISG_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

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
