"""Sub-panel "Transform Forms": the active object's local transform in every form, live."""

from __future__ import annotations

import bpy

from .main import DataPanel


class UNISG_PT_forms(DataPanel):
    """The active object's local transform in every representation form"""

    bl_label = "Transform Forms"

    def draw(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.viewport.transform_forms import transform_forms
        from ..unisg_blender.errors import UniSGError

        layout = self.layout
        if context.active_object is None:
            layout.label(text="Select an object to see its transform", icon="INFO")
            return
        try:
            forms = transform_forms(context.active_object)
        except UniSGError as error:
            layout.label(text=str(error), icon="ERROR")
            return
        for name, rows in forms.items():
            header, body = layout.panel(f"unisg_form_{name}", default_closed=name != "dual_quaternion")
            header.label(text=name)
            header.operator("unisg.copy_form", text="", icon="COPYDOWN").form = name
            if body is not None:
                _draw_channels(body, rows, columns=4 if "matrix" in name else 2)


def _draw_channels(layout: bpy.types.UILayout, rows: tuple, columns: int) -> None:
    grid = layout.grid_flow(row_major=True, columns=columns, even_columns=True, align=True)
    for channel, value in rows:
        cell = grid.row()
        cell.active = value != 0.0
        cell.label(text=f"{channel}  {value:.5g}")


CLASSES = (UNISG_PT_forms,)
