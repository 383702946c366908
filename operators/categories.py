"""Say what objects are, and keep their identities apart."""

from __future__ import annotations

import bpy


class UNISG_OT_assign_category(bpy.types.Operator):
    """Say what the selected objects are; an empty name takes the category away"""

    bl_idname = "unisg.assign_category"
    bl_label = "Assign Category"
    bl_options = {"REGISTER", "UNDO"}

    category: bpy.props.StringProperty(name="Category", description='What the objects are, for example "Scalpel"')

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if any(item.library is None for item in context.selected_objects):
            return True
        cls.poll_message_set("Select at least one object of this file (linked objects cannot be changed)")
        return False

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        active = context.active_object
        if active is not None and not self.category:
            self.category = str(active.get("unisg_category", ""))
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.authoring.identities import assign_category

        changed = assign_category(context.selected_objects, self.category)
        self.report({"INFO"}, f"{changed} objects: {self.category.strip() or 'no category'}")
        return {"FINISHED"}


class UNISG_OT_repair_identities(bpy.types.Operator):
    """Give every object of the scene a UniSG identity of its own, copies included, and write it down"""

    bl_idname = "unisg.repair_identities"
    bl_label = "Repair Identities"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.scene is not None and context.scene.objects:
            return True
        cls.poll_message_set("The scene has no objects")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.authoring.identities import repair_identities

        repaired = repair_identities(context.scene)
        self.report({"INFO"}, f"{repaired} of {len(context.scene.objects)} objects got a new identity")
        return {"FINISHED"}


CLASSES = (UNISG_OT_assign_category, UNISG_OT_repair_identities)
