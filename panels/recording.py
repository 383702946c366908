"""Sub-panel "Recording": the master file, recording and replay."""

from __future__ import annotations

import bpy

from .main import SidebarPanel


class UNISG_PT_recording(SidebarPanel, bpy.types.Panel):
    """Save the scene as a master file, record motion, replay it"""

    bl_idname = "UNISG_PT_recording"
    bl_label = "Files and Recordings"
    bl_parent_id = "UNISG_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        column.operator("unisg.convert", text="Save Master File", icon="EXPORT")
        column.operator("unisg.open_master_file", icon="IMPORT")
        column = self.layout.column(align=True)
        column.operator_context = "INVOKE_DEFAULT"
        column.operator("unisg.record", icon="REC")
        column.operator("unisg.replay", icon="PLAY")


CLASSES = (UNISG_PT_recording,)
