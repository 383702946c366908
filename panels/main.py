"""The sidebar tab "UniSG" in the 3D viewport: what the scene and the active object are."""

from __future__ import annotations

import bpy


class SidebarPanel:
    """Where all our panels live."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "UniSG"


class UNISG_PT_main(SidebarPanel, bpy.types.Panel):
    """The tab itself; everything else hangs under it."""

    bl_idname = "UNISG_PT_main"
    bl_label = "UniSG"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        active = context.active_object
        if active is None:
            column.label(text="Select an object to see what it is", icon="INFO")
        else:
            row = column.row()
            row.label(text=active.name, icon="OBJECT_DATA")
            row.label(text=str(active.get("unisg_category", "")) or "no category")
        row = column.row(align=True)
        row.operator("unisg.assign_category", icon="BOOKMARKS")
        row.operator("unisg.repair_identities", text="", icon="FILE_REFRESH")


CLASSES = (UNISG_PT_main,)
