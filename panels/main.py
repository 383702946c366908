"""The sidebar tab "UniSG" in the 3D viewport: what the scene and the active object are."""

from __future__ import annotations

import textwrap

import bpy


class SidebarPanel(bpy.types.Panel):
    """Where all our panels live."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "UniSG"


class SubPanel(SidebarPanel):
    """A panel below the tab itself."""

    bl_parent_id = "UNISG_PT_main"


class ClosedPanel(SubPanel):
    """One that is closed until a user opens it."""

    bl_options = {"DEFAULT_CLOSED"}


def draw_text(layout: bpy.types.UILayout, text: str, width: int) -> None:
    """A long text in lines that fit a sidebar of some pixels."""
    column = layout.column()
    column.scale_y = 0.7
    for number, line in enumerate(textwrap.wrap(text, max(20, width // 8))):
        column.label(text=line, icon="INFO" if number == 0 else "BLANK1")


class UNISG_PT_main(SidebarPanel):
    """The tab itself; everything else hangs under it."""

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
