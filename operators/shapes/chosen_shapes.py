"""What a user chose as the shape of a category: kept in the file, with the scene."""

from __future__ import annotations

import bpy

from ..base import Operator


class UNISG_ChosenShape(bpy.types.PropertyGroup):
    """The shape of one category, whose name is ``name``: a collection, or else an object."""

    object: bpy.props.PointerProperty(
        name="Object", type=bpy.types.Object,
        description="New things get its mesh as a linked duplicate; with modifiers or parts they are instances of it",
    )  # fmt: skip
    collection: bpy.props.PointerProperty(
        name="Collection", type=bpy.types.Collection, description="New things are instances of it"
    )


class UNISG_OT_choose_shape(Operator):
    """Choose of what shape new things of this category are; kept in this file"""

    bl_idname = "unisg.choose_shape"
    bl_label = "Choose a Shape"
    bl_options = {"REGISTER", "UNDO"}

    category: bpy.props.StringProperty(name="Category", description="Of what", options={"SKIP_SAVE"})
    remove: bpy.props.BoolProperty(
        name="Remove", description="Have no shape of one's own for it any more", options={"SKIP_SAVE"}
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        if properties.remove:
            return f"Have no shape of one's own for {properties.category} any more"
        return f"Choose of what shape a new {properties.category} is: an object or a collection; kept in this file"

    def run(self, context: bpy.types.Context) -> set[str] | None:
        shapes, category = context.scene.unisg_shapes, self.category.strip()
        number = shapes.find(category)
        if self.remove and number >= 0:
            shapes.remove(number)
        elif category and number < 0 and not self.remove:
            active, item = context.active_object, shapes.add()
            item.name = category
            if active is not None and str(active.get("unisg_category", "")) == category:
                item.object = active
        else:
            return {"CANCELLED"}
        return None


CLASSES = (UNISG_ChosenShape, UNISG_OT_choose_shape)
PROPERTIES = ((bpy.types.Scene, "unisg_shapes", bpy.props.CollectionProperty(type=UNISG_ChosenShape)),)
