"""What was generated becomes objects of the scene: in their collection, in the lesson, selected."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy

from ..room.checking import check_again
from ..shapes.given_shapes import check_sources, show_sources, without_parts
from .collections_of_new import put_home
from .suggest import suggest_again

if TYPE_CHECKING:
    from ...unisg_blender.generate import Generated


def bring_in(context: bpy.types.Context, result: Generated) -> list[bpy.types.Object]:
    """Make the new objects of the scene, and have what is listed of it looked at anew."""
    from ...unisg_blender.blender import write_rows
    from ...unisg_blender.blender.authoring.extended_lessons import extend_lessons

    check_sources(result)
    result = without_parts(result)
    extend_lessons(result.scene, result.rows.tolist(), context.scene)
    objects = write_rows(result.scene, result.rows, context.scene)
    show_sources(result, objects)
    put_home(context, objects)
    check_again()
    suggest_again()
    return objects


def select_new(context: bpy.types.Context, objects: Sequence[bpy.types.Object], kept: Sequence[str] = ()) -> None:
    """Select new objects; what is active stays so if its name is ``kept``: what they were wanted on or beside."""
    for item in context.selected_objects:
        item.select_set(False)
    in_view = [item for item in objects if item.name in context.view_layer.objects and "unisg_lsa" not in item]
    for item in in_view:
        item.select_set(True)
    active = context.active_object
    if in_view and (active is None or active.name not in kept):
        context.view_layer.objects.active = in_view[0]
