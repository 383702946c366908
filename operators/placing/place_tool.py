"""The tool in the viewport's toolbar: a click begins to place what is chosen in the tool's settings."""

from __future__ import annotations

import bpy

from ..making.generation_settings import chosen_model, load_generator


class UNISG_WT_place(bpy.types.WorkSpaceTool):
    """Place things where the model would: click to begin."""

    bl_space_type = "VIEW_3D"
    bl_context_mode = "OBJECT"
    bl_idname = "unisg.place_tool"
    bl_label = "UniSG Place"
    bl_description = "Place things where a model would: the room glows, a ghost follows the mouse, a click puts it down"
    bl_icon = "ops.transform.transform"
    bl_widget = None
    bl_keymap = (("unisg.place_chosen", {"type": "LEFTMOUSE", "value": "PRESS"}, None),)

    @staticmethod
    def draw_settings(context: bpy.types.Context, layout: bpy.types.UILayout, tool: object) -> None:
        """What is placed."""
        layout.prop(context.window_manager, "unisg_place_category", icon="OBJECT_DATA")


def _found(manager: bpy.types.WindowManager, context: bpy.types.Context, text: str) -> list[str]:
    """The categories of the chosen model that have what is typed in them."""
    names = load_generator(chosen_model(context)).categories
    return [name for name in names if text.lower() in name.lower()]


class UNISG_OT_place_chosen(bpy.types.Operator):
    """Begin to place what is chosen in the tool's settings"""

    bl_idname = "unisg.place_chosen"
    bl_label = "Place Chosen"
    bl_options = {"INTERNAL"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        category = context.window_manager.unisg_place_category
        begun = bpy.ops.unisg.place("INVOKE_DEFAULT", category=category)
        return {"CANCELLED"} if "CANCELLED" in begun else {"FINISHED"}


CLASSES = (UNISG_OT_place_chosen,)
PROPERTIES = (
    (bpy.types.WindowManager, "unisg_place_category", bpy.props.StringProperty(
        name="Thing", description="What is placed, in any words; asked for when empty", options={"SKIP_SAVE"},
        search=_found, search_options={"SUGGESTION"},
    )),
)  # fmt: skip


def register() -> None:
    """Add the tool, below Blender's own."""
    if not bpy.app.background:
        bpy.utils.register_tool(UNISG_WT_place, separator=True)


def unregister() -> None:
    """Take it out again."""
    if not bpy.app.background:
        bpy.utils.unregister_tool(UNISG_WT_place)
