"""The sidebar tab "UniSG" in the 3D viewport: its three groups, and what the active object is."""

from __future__ import annotations

import textwrap

import bpy

LETTER = 8
"""Pixels that a letter takes, at a resolution scale of 1."""


class SidebarPanel(bpy.types.Panel):
    """Where all our panels live."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "UniSG"


class SubPanel(SidebarPanel):
    """A panel of the group Make."""

    bl_parent_id = "UNISG_PT_main"


class ClosedPanel(SubPanel):
    """One that is closed until a user opens it."""

    bl_options = {"DEFAULT_CLOSED"}


class LessonPanel(SidebarPanel):
    """A panel of the group Lesson."""

    bl_parent_id = "UNISG_PT_lessons"


class DataPanel(SidebarPanel):
    """A panel of the group Data, closed until a user opens it."""

    bl_parent_id = "UNISG_PT_data"
    bl_options = {"DEFAULT_CLOSED"}


def draw_text(layout: bpy.types.UILayout, text: str, width: int, icon: str = "INFO") -> None:
    """A long text in lines that fit a sidebar of some pixels, with an icon before the first one."""
    column = layout.column()
    column.scale_y = 0.7
    letter = LETTER * (bpy.context.preferences.system.ui_scale or 1.0)  # 0 without a window
    for number, line in enumerate(textwrap.wrap(text, max(20, int(width / letter)))):
        column.label(text=line, icon=icon if number == 0 else "BLANK1")


class UNISG_PT_main(SidebarPanel):
    """Make rooms: what the active object is, new objects, what is missing, what is wrong."""

    bl_label = "Make"

    def draw(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.authoring.object_locks import is_locked

        column = self.layout.column()
        active = context.active_object
        if active is None:
            column.label(text="Select an object to see what it is", icon="INFO")
        else:
            row = column.row()
            row.label(text=active.name, icon="OBJECT_DATA")
            row.label(text=str(active.get("unisg_category", "")) or "no category")
            locked = is_locked(active)
            row.operator("unisg.lock", text="", icon="LOCKED" if locked else "UNLOCKED", depress=locked)
        row = column.row(align=True)
        row.operator("unisg.assign_category", icon="BOOKMARKS")
        row.operator("unisg.repair_identities", text="", icon="FILE_REFRESH")


class UNISG_PT_lessons(SidebarPanel):
    """Author and play what is to be done in the scene."""

    bl_label = "Lesson"

    def draw(self, context: bpy.types.Context) -> None:
        """Its panels say it all."""


class UNISG_PT_data(SidebarPanel):
    """Datasets, recordings and what networks say of the scene."""

    bl_label = "Data"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Its panels say it all."""


CLASSES = (UNISG_PT_main, UNISG_PT_lessons, UNISG_PT_data)
