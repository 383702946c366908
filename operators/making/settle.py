"""Settle the selected objects."""

from __future__ import annotations

import bpy

from ..base import Operator
from ..room.checking import check_again
from .movable_objects import LINKED, movable


class UNISG_OT_settle(Operator):
    """Move the selected objects onto what is below them, apart from each other and into the room"""

    bl_idname = "unisg.settle"
    bl_label = "Settle Selected"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        if context.mode != "OBJECT":
            return "Leave edit mode first"
        meshes = [item for item in context.selected_objects if item.type == "MESH"]
        if not meshes:
            return "Select objects with meshes first"
        return "" if movable(meshes) else LINKED

    def run(self, context: bpy.types.Context) -> set[str]:
        import mathutils

        from ...unisg_blender.blender import objects_by_uid, read_scene
        from ...unisg_blender.blender.scene_units import metres_per_unit, scale_translations
        from ...unisg_blender.generate.check.settled_scene import settle_rows
        from ...unisg_blender.runtime.wording import grouped

        graph = read_scene(context.scene, details=False)
        items = objects_by_uid(context.scene)
        chosen = set(movable(context.selected_objects))
        units = 1.0 / metres_per_unit(context.scene)
        found = settle_rows(graph, [row for row, uid in enumerate(graph.uid) if items.get(uid) in chosen])
        for settled in found:
            if settled.note:
                continue
            place = scale_translations(settled.world, units)
            items[graph.uid[settled.row]].matrix_world = mathutils.Matrix(place.tolist())
            context.view_layer.update()  # parents come first: the next one is set in the world again
        moved = sum(not settled.note for settled in found)
        self.report({"INFO"}, f"{moved} of {len(found)} objects settled")
        notes = [(graph.name[settled.row], settled.note) for settled in found if settled.note]
        for line in grouped(notes):  # last: the status bar shows the last report only
            self.report({"WARNING"}, line)
        if moved:
            check_again()
        return {"FINISHED"} if moved else {"CANCELLED"}


CLASSES = (UNISG_OT_settle,)
