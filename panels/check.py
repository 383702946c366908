"""Sub-panel "Check": what is wrong in the scene; a click goes there."""

from __future__ import annotations

import bpy

from ..operators.room.checking import checking
from .main import ClosedPanel, draw_text

ICONS = {"collides": "MOD_BOOLEAN", "floats": "SORT_DESC", "blocks": "CANCEL", "outside": "HOME"}

NAME = 0.4
"""Share of a row that the name of the object takes."""


class UNISG_UL_faults(bpy.types.UIList):
    """Objects with what is wrong with them; a click selects one and brings it into view."""

    def draw_item(
        self, context: bpy.types.Context, layout: bpy.types.UILayout, data: object, item: bpy.types.PropertyGroup,
        icon: int, active_data: object, active_property: str, index: int = 0, flt_flag: int = 0,
    ) -> None:  # fmt: skip
        row = layout.split(factor=NAME)
        row.label(text=item.name, icon=ICONS.get(item.state, "ERROR"))
        row.label(text=item.text.replace("collides with", "in"))


class UNISG_PT_check(ClosedPanel):
    """What collides, floats, is outside or blocks a door"""

    bl_label = "Check"

    def draw(self, context: bpy.types.Context) -> None:
        layout, found = self.layout, context.window_manager.unisg_check
        if checking():  # no grey button: it would stay grey as long as the mouse is on it
            layout.label(text="Checking ...", icon="SORTTIME")
            return
        layout.operator("unisg.check", icon="VIEWZOOM")
        if found.scene != context.scene.name:
            return
        draw_text(layout, found.summary, context.region.width)
        if found.old:
            layout.label(text="Changed since: check again", icon="FILE_REFRESH")
        if len(found.faults):
            layout.template_list("UNISG_UL_faults", "", found, "faults", found, "active", rows=4)
            if 0 <= found.active < len(found.faults):
                chosen = found.faults[found.active]
                draw_text(layout, f"{chosen.name} {chosen.text}", context.region.width)
            row = layout.row(align=True)
            row.operator("unisg.select_faults", icon="RESTRICT_SELECT_OFF")
            row.operator("unisg.settle", icon="TRIA_DOWN_BAR")


CLASSES = (UNISG_UL_faults, UNISG_PT_check)
