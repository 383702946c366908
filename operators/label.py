"""Propose categories for objects that have none; accept them one by one or all."""

from __future__ import annotations

import bpy

from ..unisg_blender.errors import UniSGError
from .base import Operator


class UNISG_OT_label(Operator):
    """Propose categories for objects without one, from shape, size, name and neighbours; nothing is changed yet"""

    bl_idname = "unisg.label"
    bl_label = "Propose Categories"
    bl_options = {"REGISTER"}

    selected_only: bpy.props.BoolProperty(name="Selected only", description="Look at the selected objects only")

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        if context.mode != "OBJECT":
            return "Leave edit mode first"
        left = any(item.type == "MESH" and not item.get("unisg_category") for item in context.scene.objects)
        return "" if left else "All mesh objects of the scene have a category"

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.read.scene_reader import read_scene
        from ..unisg_blender.predict.category_proposals import propose_categories

        settings = context.window_manager.unisg_meshes
        settings.proposals.clear()
        graph = read_scene(context.scene, details=False)
        rows = [row for row in range(len(graph)) if graph.category[row] < 0]
        if self.selected_only:
            selected = {item.name for item in context.selected_objects}
            rows = [row for row in rows if graph.name[row] in selected]
        found = propose_categories(graph, rows=rows)
        for proposal in sorted(found, key=lambda proposal: -proposal.confidence):
            item = settings.proposals.add()
            item.name, item.uid, item.known = proposal.name, proposal.uid, proposal.known
            for category, confidence in proposal.categories:
                guess = item.guesses.add()
                guess.name, guess.confidence = category, confidence
        known = sum(proposal.known for proposal in found)
        self.report({"INFO"}, f"{known} of {len(found)} objects are known; the others have guesses only")


class UNISG_OT_accept_category(Operator):
    """Give the object this category"""

    bl_idname = "unisg.accept_category"
    bl_label = "Accept"
    bl_options = {"REGISTER", "UNDO"}

    uid: bpy.props.StringProperty(options={"HIDDEN"})
    category: bpy.props.StringProperty(name="Category")

    def run(self, context: bpy.types.Context) -> None:
        if not accept(context, {self.uid: self.category}):
            raise UniSGError("the object is no longer there, or is linked: propose again")


class UNISG_OT_accept_categories(Operator):
    """Give all objects their most likely category, where its confidence is high enough"""

    bl_idname = "unisg.accept_categories"
    bl_label = "Accept All"
    bl_options = {"REGISTER", "UNDO"}

    threshold: bpy.props.FloatProperty(
        name="Confidence", description="Accept from here on", default=0.6, min=0, max=1, subtype="FACTOR"
    )

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if len(context.window_manager.unisg_meshes.proposals) else "Propose categories first"

    def run(self, context: bpy.types.Context) -> None:
        proposals = context.window_manager.unisg_meshes.proposals
        best = {item.uid: item.guesses[0] for item in proposals}
        wanted = {uid: guess.name for uid, guess in best.items() if guess.confidence >= self.threshold}
        total = len(proposals)
        self.report({"INFO"}, f"{accept(context, wanted)} of {total} objects got their category")


def accept(context: bpy.types.Context, wanted: dict[str, str]) -> int:
    """Give objects (by uid) categories and take them off the list; returns how many were changed."""
    from ..unisg_blender.blender import objects_by_uid
    from ..unisg_blender.blender.authoring.identities import assign_category

    objects = objects_by_uid(context.scene)
    changed = sum(assign_category([objects[uid]], category) for uid, category in wanted.items() if uid in objects)
    proposals = context.window_manager.unisg_meshes.proposals
    for place in reversed(range(len(proposals))):
        if proposals[place].uid in wanted:
            proposals.remove(place)
    return changed


CLASSES = (UNISG_OT_label, UNISG_OT_accept_category, UNISG_OT_accept_categories)
