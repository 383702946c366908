"""Copy a transform in one representation form; switch the form microscope."""

from __future__ import annotations

import bpy


class UNISG_OT_copy_form(bpy.types.Operator):
    """Copy the active object's local transform in this form to the clipboard, as JSON with channel names"""

    bl_idname = "unisg.copy_form"
    bl_label = "Copy Form"
    bl_options = {"INTERNAL"}

    form: bpy.props.StringProperty(name="Form", default="dual_quaternion")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.active_object is not None:
            return True
        cls.poll_message_set("Select an object first")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.viewport.transform_forms import transform_forms, transform_text
        from ..unisg_blender.errors import UniSGError

        try:
            if self.form not in transform_forms(context.active_object):
                raise UniSGError(f"there is no form {self.form!r}")
            context.window_manager.clipboard = transform_text(context.active_object, self.form)
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{self.form} copied")
        return {"FINISHED"}


def _switch(settings: UNISG_PG_microscope, context: bpy.types.Context) -> None:
    from ..unisg_blender.blender.viewport import motion_paths as microscope

    microscope.start() if settings.show else microscope.stop()
    _redraw(settings, context)


def _redraw(settings: UNISG_PG_microscope, context: bpy.types.Context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


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
        update=_redraw,
    )


CLASSES = (UNISG_OT_copy_form, UNISG_PG_microscope)


def register() -> None:
    """Add the microscope's settings to the window manager: they belong to the session, not to the file."""
    bpy.types.WindowManager.unisg_microscope = bpy.props.PointerProperty(type=UNISG_PG_microscope)


def unregister() -> None:
    """Stop drawing and take the settings away."""
    from ..unisg_blender.blender.viewport import motion_paths as microscope

    microscope.stop()
    del bpy.types.WindowManager.unisg_microscope
