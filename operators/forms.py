"""Copy a transform in one representation form; switch the form microscope."""

from __future__ import annotations

import sys

import bpy

from ..unisg_blender.errors import UniSGError, did_you_mean
from .base import Operator, redraw_views


class UNISG_OT_copy_form(Operator):
    """Copy the active object's local transform in this form to the clipboard, as JSON with channel names"""

    bl_idname = "unisg.copy_form"
    bl_label = "Copy Form"
    bl_options = {"INTERNAL"}

    form: bpy.props.StringProperty(name="Form", default="dual_quaternion")

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if context.active_object is not None else "Select an object first"

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.viewport.transform_forms import transform_forms, transform_text

        forms = transform_forms(context.active_object)
        if self.form not in forms:
            raise UniSGError(f"there is no form {self.form!r}{did_you_mean(self.form, forms)}")
        context.window_manager.clipboard = transform_text(context.active_object, self.form)
        self.report({"INFO"}, f"{self.form} copied")


def _switch(settings: UNISG_PG_microscope, context: bpy.types.Context) -> None:
    from ..unisg_blender.blender.viewport import motion_paths as microscope

    microscope.start() if settings.show else microscope.stop()
    redraw_views(context)


class UNISG_PG_microscope(bpy.types.PropertyGroup):
    """Settings of the form microscope."""

    show: bpy.props.BoolProperty(
        name="Form Microscope",
        description="Draw the paths between the active object's two keyed poses around this frame, "
        "as matrices, quaternions and motors interpolate them",
        update=_switch,
    )
    spread: bpy.props.FloatProperty(
        name="Side by Side",
        description="How far apart the paths are drawn, in lengths of the motion; 0 lays them over each other",
        default=0.5,
        min=0.0,
        soft_max=3.0,
        update=lambda settings, context: redraw_views(context),
    )


CLASSES = (UNISG_OT_copy_form, UNISG_PG_microscope)
PROPERTIES = ((bpy.types.WindowManager, "unisg_microscope", bpy.props.PointerProperty(type=UNISG_PG_microscope)),)
"""The microscope's settings belong to the session, not to the file."""


def unregister() -> None:
    """Stop drawing, if anything was drawn: nothing is loaded for that."""
    microscope = sys.modules.get(f"{__package__.rpartition('.')[0]}.unisg_blender.blender.viewport.motion_paths")
    if microscope is not None:
        microscope.stop()
