"""The Generate panel: a model, categories with counts, and a button."""

from __future__ import annotations

import bpy

from ..operators.making.generation_settings import OWN_FILE, UNISG_GenerationSettings, list_categories_soon, loading
from ..operators.making.understand import UNDERSTOOD
from .main import ClosedPanel, SubPanel, draw_text

SHOWN = 8


class UNISG_UL_categories(bpy.types.UIList):
    """Categories of the model, each with how many are wanted."""

    def draw_item(
        self, context: bpy.types.Context, layout: bpy.types.UILayout, data: object, item: bpy.types.PropertyGroup,
        icon: int, active_data: object, active_property: str, index: int = 0, flt_flag: int = 0,
    ) -> None:  # fmt: skip
        row = layout.split(factor=0.72)
        row.label(text=item.name)
        row.prop(item, "count", text="")


class UNISG_PT_generate(SubPanel):
    """Add objects with a trained model."""

    bl_label = "Generate"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.window_manager.unisg
        layout.prop(settings, "model")
        if settings.model == OWN_FILE:
            layout.prop(settings, "path")
        if settings.listed != (settings.model_file() or "-"):
            list_categories_soon()
        if loading():
            layout.label(text="Loading the model ...", icon="SORTTIME")
        if settings.problem:
            box = layout.box().column()
            box.alert = True
            draw_text(box, settings.problem, context.region.width)
            return
        layout.template_list("UNISG_UL_categories", "", settings, "counts", settings, "active", rows=6)
        row = layout.row(align=True)
        row.prop(settings, "seed")
        row.prop(settings, "bulk", toggle=True)
        row = layout.row(align=True)
        row.prop(settings, "variety")
        row.prop(settings, "candidates")
        _where(layout, settings, context.active_object)
        layout.prop(settings, "behaviour")
        _button(layout, settings, context.active_object)
        layout.operator("unisg.choose_and_place", text="Place by Pointing...", icon="CURSOR")
        row = layout.row(align=True)
        row.operator("unisg.settle", text="Settle", icon="TRIA_DOWN_BAR")
        row.operator("unisg.reroll", text="Re-roll", icon="FILE_REFRESH")


class UNISG_PT_known(ClosedPanel):
    """What the model knows of the scene, and the file that says what words mean"""

    bl_label = "What the Model Knows"

    def draw(self, context: bpy.types.Context) -> None:
        _known(self.layout, context.window_manager.unisg, context)


def _where(layout: bpy.types.UILayout, settings: UNISG_GenerationSettings, active: bpy.types.Object | None) -> None:
    """The choice of a place, and in full which object is meant: a button would cut off its name."""
    column = layout.column(align=True)
    column.prop(settings, "where")
    if settings.where == "ANYWHERE":
        return
    if settings.where == "IN":
        column.prop(settings, "room", icon="HOME")
        return
    if active is None:
        column.label(text="No object is active", icon="INFO")
    else:
        column.label(text=f"{settings.where.capitalize()} {active.name}", icon="OBJECT_DATA")


def _known(layout: bpy.types.UILayout, settings: UNISG_GenerationSettings, context: bpy.types.Context) -> None:
    """What the model knows of the scene, once it was asked, and the file that changes it."""
    column = layout.column(align=True)
    button = column.operator("unisg.understand", icon="QUESTION")
    button.model, button.words = settings.model_file(), settings.words
    column.prop(settings, "words")
    lines = UNDERSTOOD.get(context.scene.name, [])
    for line in lines[:SHOWN]:
        draw_text(column, line, context.region.width)
    if len(lines) > SHOWN:
        column.label(text=f"... and {len(lines) - SHOWN} more")


def _button(layout: bpy.types.UILayout, settings: UNISG_GenerationSettings, active: bpy.types.Object | None) -> None:
    """The button that generates; its text says why if it is grey."""
    total, lacks = sum(settings.wanted().values()), settings.lacks(active)
    column = layout.column()
    column.enabled = not lacks
    column.scale_y = 1.4
    text = f"{lacks} to generate" if lacks else f"Generate {total} object{'s' * (total != 1)}"
    settings.hand_over(column.operator("unisg.generate", text=text, icon="ADD"), active)


CLASSES = (UNISG_UL_categories, UNISG_PT_generate, UNISG_PT_known)
