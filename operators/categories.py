"""Say what objects are, and keep their identities apart."""

from __future__ import annotations

import bpy

from .base import Operator


class UNISG_OT_assign_category(Operator):
    """Say what the selected objects are; an empty name takes the category away"""

    bl_idname = "unisg.assign_category"
    bl_label = "Assign Category"
    bl_options = {"REGISTER", "UNDO"}

    category: bpy.props.StringProperty(
        name="Category", description='What the objects are, for example "Scalpel"', options={"SKIP_SAVE"}
    )

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        if any(item.library is None for item in context.selected_objects):
            return ""
        return "Select at least one object of this file (linked objects cannot be changed)"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        active = context.active_object
        if active is not None and not self.category:
            self.category = str(active.get("unisg_category", ""))
        return context.window_manager.invoke_props_dialog(self)

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.authoring.identities import assign_category

        changed = assign_category(context.selected_objects, self.category)
        self.report({"INFO"}, f"{changed} objects: {self.category.strip() or 'no category'}")


class UNISG_OT_repair_identities(Operator):
    """Give every object of the scene a UniSG identity of its own, copies included, and write it down"""

    bl_idname = "unisg.repair_identities"
    bl_label = "Repair Identities"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if context.scene is not None and context.scene.objects else "The scene has no objects"

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.authoring.identities import repair_identities

        repaired = repair_identities(context.scene)
        self.report({"INFO"}, f"{repaired} of {len(context.scene.objects)} objects got a new identity")


CLASSES = (UNISG_OT_assign_category, UNISG_OT_repair_identities)
