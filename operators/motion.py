"""Screw interpolation and keyframe reduction of the selected objects' or bones' animation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy

from ..unisg_blender.errors import UniSGError
from .base import Operator

if TYPE_CHECKING:
    from ..unisg_blender.blender.fcurves import Item
    from ..unisg_blender.blender.motion.motor_keys import MotionReport, Tolerance


def _items(context: bpy.types.Context) -> list[Item]:
    """Selected bones in pose mode, else selected objects; only those whose animation this file owns."""
    items = context.selected_pose_bones if context.mode == "POSE" else context.selected_objects
    return [item for item in items or () if (action := _action(item)) is not None and action.library is None]


def _action(item: Item) -> bpy.types.Action | None:
    data = item.id_data.animation_data
    return None if data is None else data.action


class MotionOperator(Operator):
    """What both operators share: where they work, their tolerances, and how they report."""

    bl_options = {"REGISTER", "UNDO"}

    millimetres: bpy.props.FloatProperty(
        name="Millimetres", description="How far any frame may be off in place", default=0.1, min=1e-4, soft_max=100.0
    )
    degrees: bpy.props.FloatProperty(
        name="Degrees", description="How far any frame may be off in turn", default=0.05, min=1e-4, soft_max=10.0
    )

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if _items(context) else "Select an object, or a bone in pose mode, that is animated in this file"

    def change(self, item: Item, tolerance: Tolerance) -> MotionReport:
        """Change one item's keys."""
        raise NotImplementedError

    def summary(self, reports: Sequence[MotionReport]) -> str:
        """What to say of all that was done."""
        raise NotImplementedError

    def run(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.motion.motor_keys import Tolerance
        from ..unisg_blender.blender.scene_units import metres_per_unit

        metres = metres_per_unit(context.scene)
        tolerance, reports, done = Tolerance(self.millimetres, self.degrees, metres), [], set()
        for item in _items(context):
            owner = (
                _action(item),
                getattr(item.id_data.animation_data, "action_slot", None),
                item.path_from_id() if hasattr(item, "bone") else "",
            )
            if owner in done:  # objects that share an action share its keys
                continue
            done.add(owner)
            try:
                reports.append(self.change(item, tolerance))
            except UniSGError as error:
                self.report({"WARNING"}, str(error))
        if not reports:
            return {"CANCELLED"}
        self.report({"INFO"}, self.summary(reports))
        return {"FINISHED"}


class UNISG_OT_interpolate_motors(MotionOperator):
    """Move along screws between the keyed poses of the selection: turn and slide about one axis at constant speed"""

    bl_idname = "unisg.interpolate_motors"
    bl_label = "Interpolate with Motors"

    def change(self, item: Item, tolerance: Tolerance) -> MotionReport:
        from ..unisg_blender.blender.motion.motor_keys import interpolate_with_motors

        return interpolate_with_motors(item, tolerance)

    def summary(self, reports: Sequence[MotionReport]) -> str:
        long_turns = sum(report.long_turns for report in reports)
        note = f"; {long_turns} spans turned more than half a turn and now take the short way" if long_turns else ""
        return f"{_count(reports)} on screws, {_errors(reports)}{note}"


class UNISG_OT_reduce_keyframes(MotionOperator):
    """Keep few location and rotation keys of the selection, from which screws rebuild the motion within tolerance"""

    bl_idname = "unisg.reduce_keyframes"
    bl_label = "Reduce Keyframes"

    def change(self, item: Item, tolerance: Tolerance) -> MotionReport:
        from ..unisg_blender.blender.motion.motor_keys import reduce_item_keyframes

        return reduce_item_keyframes(item, tolerance)

    def summary(self, reports: Sequence[MotionReport]) -> str:
        before, after = (sum(getattr(report, name) for report in reports) for name in ("keys_before", "keys_after"))
        kept = sum(not report.changed for report in reports)
        note = f"; {kept} had no key to spare" if kept else ""
        return f"{_count(reports)}: {before} keys became {after}, {before - after} saved, {_errors(reports)}{note}"


def _count(reports: Sequence[MotionReport]) -> str:
    return f"{len(reports)} motion" + ("" if len(reports) == 1 else "s")


def _errors(reports: Sequence[MotionReport]) -> str:
    millimetres = max(report.millimetres for report in reports)
    degrees = max(report.degrees for report in reports)
    return f"at most {millimetres:.3g} mm and {degrees:.3g} degrees off"


CLASSES = (UNISG_OT_interpolate_motors, UNISG_OT_reduce_keyframes)
