"""Lock objects: nothing moves them but the user."""

from __future__ import annotations

import bpy

from ..base import Operator, redraw_views


class UNISG_OT_lock(Operator):
    """Lock the selected objects, or set them free if all are locked: Settle and Re-roll leave locked ones alone"""

    bl_idname = "unisg.lock"
    bl_label = "Lock / Unlock"
    bl_options = {"REGISTER", "UNDO"}

    how: bpy.props.EnumProperty(
        name="How",
        items=(
            ("TOGGLE", "Toggle", "Set them free if all are locked, else lock them"),
            ("LOCK", "Lock", "Only the user moves them"),
            ("FREE", "Set Free", "They can be settled and placed anew"),
        ),
        options={"SKIP_SAVE"},
    )

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if any(item.library is None for item in context.selected_objects) else "Select objects of this file"

    def run(self, context: bpy.types.Context) -> None:
        from ...unisg_blender.blender.authoring.object_locks import is_locked, set_locked

        chosen = [item for item in context.selected_objects if item.library is None]
        lock = self.how == "LOCK" or (self.how == "TOGGLE" and not all(map(is_locked, chosen)))
        count = set_locked(chosen, lock)
        self.report({"INFO"}, f"{count} object{'s' * (count != 1)} {'locked' if lock else 'set free'}")
        redraw_views(context)


CLASSES = (UNISG_OT_lock,)
