"""Settle the selected objects."""

from __future__ import annotations

import bpy


class UNISG_OT_settle(bpy.types.Operator):
    """Move the selected objects onto what is below them, apart from each other and into the room"""

    bl_idname = "unisg.settle"
    bl_label = "Settle Selected"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Leave edit mode first")
            return False
        if any(item.type == "MESH" for item in context.selected_objects):
            return True
        cls.poll_message_set("Select objects with meshes first")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        import mathutils

        from ..unisg_blender.blender import objects_by_uid, read_scene
        from ..unisg_blender.errors import UniSGError
        from ..unisg_blender.generate.place.settle_scene import settle_rows

        try:
            graph = read_scene(context.scene, details=False)
            items = objects_by_uid(context.scene)
            chosen = set(context.selected_objects)
            found = settle_rows(graph, [row for row, uid in enumerate(graph.uid) if items.get(uid) in chosen])
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for settled in found:
            if settled.note:
                continue
            items[graph.uid[settled.row]].matrix_world = mathutils.Matrix(settled.world.tolist())
            context.view_layer.update()  # parents come first: the next one is set in the world again
        moved = sum(not settled.note for settled in found)
        self.report({"INFO"}, f"{moved} of {len(found)} objects settled")
        for settled in found:  # last: the status bar shows the last report only
            if settled.note:
                self.report({"WARNING"}, f"{graph.name[settled.row]}: {settled.note}")
        return {"FINISHED"} if moved else {"CANCELLED"}


CLASSES = (UNISG_OT_settle,)
