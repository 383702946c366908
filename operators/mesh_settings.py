"""What the mesh panel shows: proposed categories, similar assets, and the user's choices.

They live in the window manager: undo leaves them alone, and no file keeps them.
"""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent


def show_proposal(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Select the object of the proposal that was clicked on."""
    if not 0 <= settings.active < len(settings.proposals) or context.mode != "OBJECT":
        return
    item = context.view_layer.objects.get(settings.proposals[settings.active].name)
    if item is None or not item.visible_get():
        return
    for other in context.selected_objects:
        other.select_set(False)
    item.select_set(True)
    context.view_layer.objects.active = item


class UNISG_PG_guess(bpy.types.PropertyGroup):
    """One category that an object may have."""

    confidence: bpy.props.FloatProperty()


class UNISG_PG_proposal(bpy.types.PropertyGroup):
    """An object without a category, and what it may be, best first."""

    uid: bpy.props.StringProperty(options={"HIDDEN"})
    known: bpy.props.BoolProperty(description="Whether the model knows what it is")
    guesses: bpy.props.CollectionProperty(type=UNISG_PG_guess)


class UNISG_PG_match(bpy.types.PropertyGroup):
    """An asset that is like the active object."""

    distance: bpy.props.FloatProperty()


class UNISG_PG_meshes(bpy.types.PropertyGroup):
    """Choices and results of the mesh panel."""

    faces: bpy.props.IntProperty(
        name="Faces", description="Triangles of a decoded mesh", default=5000, min=4, max=200000
    )
    folder: bpy.props.StringProperty(
        name="Library",
        description="Folder of mesh files to search; empty: the objects of this scene",
        subtype="DIR_PATH",
    )
    threshold: bpy.props.FloatProperty(
        name="From Confidence",
        description="Accept all proposals from here on",
        default=0.6,
        min=0,
        max=1,
        subtype="FACTOR",
    )
    selected_only: bpy.props.BoolProperty(name="Selected only", description="Propose for the selected objects only")
    proposals: bpy.props.CollectionProperty(type=UNISG_PG_proposal)
    active: bpy.props.IntProperty(update=show_proposal)
    matches: bpy.props.CollectionProperty(type=UNISG_PG_match)
    matched: bpy.props.StringProperty(description="Name of the object that the matches are for")


@persistent
def _loaded(*_: object) -> None:
    """Another file: what was proposed and found was of the things of the one before."""
    settings = bpy.context.window_manager.unisg_meshes
    settings.proposals.clear()
    settings.matches.clear()


HANDLERS = (("load_post", _loaded),)
CLASSES = (UNISG_PG_guess, UNISG_PG_proposal, UNISG_PG_match, UNISG_PG_meshes)
PROPERTIES = ((bpy.types.WindowManager, "unisg_meshes", bpy.props.PointerProperty(type=UNISG_PG_meshes)),)
