"""Sub-panel "Suggest": what is missing here, how likely; a click places it."""

from __future__ import annotations

import bpy

from ..operators.making.suggest import suggesting
from .main import SubPanel, draw_text


class UNISG_PT_suggest(SubPanel):
    """What is missing here by the model, how likely; a click places it"""

    bl_label = "Suggest"

    def draw(self, context: bpy.types.Context) -> None:
        layout, found, settings = self.layout, context.window_manager.unisg_suggested, context.window_manager.unisg
        if suggesting():
            layout.label(text="Looking at the scene ...", icon="SORTTIME")
            return
        layout.operator("unisg.suggest", icon="LIGHT")
        if (found.scene, found.model) != (context.scene.name, settings.model_file()):
            return  # of another scene, or another model's
        if found.objects != len(context.scene.objects):
            layout.label(text="Changed since: look again", icon="FILE_REFRESH")
        if found.text:
            draw_text(layout, found.text, context.region.width)
        column = layout.column(align=True)
        for item in found.things:
            row = column.split(factor=0.8, align=True)
            row.progress(factor=item.share, text=f"{_numbered(item)}: {100 * item.share:.0f} %")
            button = row.operator("unisg.generate", text="", icon="ADD")
            button.model, button.add = found.model, f"{item.name}=1"
            for name in ("seed", "behaviour", "words", "variety", "candidates"):
                setattr(button, name, getattr(settings, name))


def _numbered(item: bpy.types.PropertyGroup) -> str:
    """What would be placed: "Chair", or "Chair (there are 3)"."""
    return item.name if not item.count else f"{item.name} (has {item.count})"


CLASSES = (UNISG_PT_suggest,)
