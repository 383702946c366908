"""Choose what to place from a list that is searched by typing."""

from __future__ import annotations

import bpy

from ..base import SearchOperator
from ..making.generation_settings import load_generator, shipped_models

OWN = "OBJECT:"
_items: list[tuple[str, str, str]] = []


def _choices(operator: object, context: bpy.types.Context | None) -> list[tuple[str, str, str]]:
    """What the chosen model knows, and the active object."""
    found = []
    if context is not None:
        active = context.active_object
        if active is not None and active.type in ("MESH", "EMPTY"):
            found.append((f"{OWN}{active.name}", f"Another {active.name}", "The active object once more"))
        model = context.window_manager.unisg.model_file() or str(next(iter(shipped_models()), ""))
        names = load_generator(model).categories if model else ()
        found += [(name, name, f"{name}, as the model knows it") for name in names]
    _items[:] = found  # Blender keeps no reference to the strings of a computed enum: we must
    return _items


class UNISG_OT_choose_and_place(SearchOperator):
    """Choose what to place by pointing: what the model knows, or the active object once more"""

    bl_idname = "unisg.choose_and_place"
    bl_label = "Place..."
    bl_options = {"INTERNAL"}
    bl_property = "thing"

    thing: bpy.props.EnumProperty(name="Thing", items=_choices, options={"SKIP_SAVE"})

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if context.mode == "OBJECT" else "Leave edit mode first"

    def run(self, context: bpy.types.Context) -> None:
        if self.thing.startswith(OWN):
            bpy.ops.unisg.place("INVOKE_DEFAULT", source=self.thing.removeprefix(OWN))
        else:
            bpy.ops.unisg.place("INVOKE_DEFAULT", category=self.thing)


CLASSES = (UNISG_OT_choose_and_place,)
