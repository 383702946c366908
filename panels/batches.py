"""Many rooms, and many pictures, of the open scene."""

from __future__ import annotations

import bpy

from .main import DataPanel, draw_text


class UNISG_PT_batches(DataPanel):
    """Make variations of the scene in number, and pictures with labels"""

    bl_label = "Variations and Pictures"

    def draw(self, context: bpy.types.Context) -> None:
        layout, status = self.layout, context.window_manager.unisg_batch_status
        column = layout.column(align=True)
        column.operator("unisg.make_variations_dialog", icon="DUPLICATE")
        column.operator("unisg.render_labels_dialog", icon="RENDER_STILL")
        if status:
            draw_text(layout, f"{status}   ESC: stop", context.region.width)


CLASSES = (UNISG_PT_batches,)
