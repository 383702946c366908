"""The Meshes panel: shapes as features, and proposed categories."""

from __future__ import annotations

import bpy

from .main import ClosedPanel, DataPanel


class UNISG_UL_proposals(bpy.types.UIList):
    """Objects with their most likely category."""

    def draw_item(
        self, context: bpy.types.Context, layout: bpy.types.UILayout, data: object, item: bpy.types.PropertyGroup,
        icon: int, active_data: object, active_property: str, index: int = 0, flt_flag: int = 0,
    ) -> None:  # fmt: skip
        row = layout.split(factor=0.45)
        row.label(text=item.name)
        guess = item.guesses[0]
        row.label(text=f"{guess.confidence:.0%} {guess.name}" if item.known else f"not known ({guess.name}?)")


class UNISG_PT_label(ClosedPanel):
    """Categories for objects that have none."""

    bl_label = "Categories"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.window_manager.unisg_meshes
        layout.prop(settings, "selected_only")
        layout.operator("unisg.label", icon="VIEWZOOM").selected_only = settings.selected_only
        if not len(settings.proposals):
            return
        layout.template_list("UNISG_UL_proposals", "", settings, "proposals", settings, "active", rows=5)
        if settings.active < len(settings.proposals):
            chosen = settings.proposals[settings.active]
            column = layout.column(align=True)
            for guess in chosen.guesses:
                button = column.operator("unisg.accept_category", text=f"{guess.name} ({guess.confidence:.0%})")
                button.uid, button.category = chosen.uid, guess.name
        column = layout.column(align=True)
        column.prop(settings, "threshold", slider=True)
        column.operator("unisg.accept_categories", icon="CHECKMARK").threshold = settings.threshold


class UNISG_PT_meshes(DataPanel):
    """The active object's shape."""

    bl_label = "Meshes"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.window_manager.unisg_meshes
        column = layout.column(align=True)
        column.operator("unisg.encode_mesh", icon="MESH_ICOSPHERE")
        item = context.active_object
        if item is not None and item.type == "MESH" and "unisg_mesh_feature" in item.data:
            column.label(text="Feature kept with the mesh", icon="CHECKMARK")
        column = layout.column(align=True)
        column.prop(settings, "faces")
        column.operator("unisg.decode_mesh", icon="MESH_UVSPHERE").faces = settings.faces
        column = layout.column(align=True)
        column.prop(settings, "folder")
        where = "Library" if settings.folder else "Scene"
        column.operator("unisg.find_similar", text=f"Find Similar in {where}", icon="VIEWZOOM").folder = settings.folder
        if len(settings.matches):
            box = layout.box().column()
            box.label(text=f"Like {settings.matched}:")
            for match in settings.matches:
                row = box.row()
                row.label(text=bpy.path.basename(match.name) or match.name)
                row.label(text=f"{match.distance:.2f}")


CLASSES = (UNISG_UL_proposals, UNISG_PT_label, UNISG_PT_meshes)
