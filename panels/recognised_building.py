"""Sub-panel "Building": what is recognised of the building, shown and corrected."""

from __future__ import annotations

import bpy

from ..operators.room.corrections import PARTS
from ..operators.room.recognised import looking, problem, recognised
from .main import ClosedPanel, draw_text

SHOWN = 12


class UNISG_PT_building(ClosedPanel):
    """Rooms, floors, walls, doors and surfaces that are recognised; what is wrong can be corrected"""

    bl_label = "Building"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        row = layout.row(align=True)
        row.prop(context.window_manager, "unisg_structure_shown", toggle=True, icon="HOME")
        row.operator("unisg.recognise", text="", icon="FILE_REFRESH")
        _rooms(layout, context)
        _parts(layout, context)


def _rooms(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What was recognised, a line for each room, with a button that says what it is."""
    found, trouble = recognised(context.scene), problem(context.scene)
    column = layout.column(align=True)
    if trouble:
        draw_text(column, trouble, context.region.width)
    elif looking():
        column.label(text="Looking at the scene ...", icon="SORTTIME")
    if found is None:
        return
    draw_text(column, found.summary, context.region.width)
    for number, line in enumerate(found.room_lines()[:SHOWN]):
        row = column.row()
        row.label(text=line)
        button = row.operator("unisg.mark_room", text="", icon="GREASEPENCIL")
        button.number, button.kind = number, found.names[number].kind
    if len(found.structure.rooms) > SHOWN:
        column.label(text=f"... and {len(found.structure.rooms) - SHOWN} more")


def _parts(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What the active object is taken for, and buttons that say what the selected ones are."""
    column = layout.column(align=True)
    draw_text(column, _taken_for(context), context.region.width)
    grid = column.grid_flow(columns=2, even_columns=True, align=True, row_major=True)
    for key, label, _ in PARTS:
        grid.operator("unisg.mark_part", text=label).part = key or "CLEAR"


def _taken_for(context: bpy.types.Context) -> str:
    """What the active object counts as."""
    item, found = context.active_object, recognised(context.scene)
    if item is None:
        return "Selected objects are:"
    mark, category = str(item.get("unisg_structure", "")), str(item.get("unisg_category", ""))
    if mark or category:
        said = next((label.lower() for key, label, _ in PARTS if key and key == mark.upper()), "")
        return f"{item.name}: {said or category}, as you say"
    row = found.row_of_name.get(item.name, -1) if found is not None else -1
    kinds = found.structure.parts.get(row, ()) if found is not None else ()
    return f"{item.name}: {', '.join(kinds)}, as recognised" if kinds else f"{item.name} is:"


CLASSES = (UNISG_PT_building,)
