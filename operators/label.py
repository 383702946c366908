"""Propose categories for objects that have none; accept them one by one or all."""

from __future__ import annotations

import bpy


class UNISG_OT_label(bpy.types.Operator):
    """Propose categories for objects without one, from shape, size, name and neighbours; nothing is changed yet"""

    bl_idname = "unisg.label"
    bl_label = "Propose Categories"
    bl_options = {"REGISTER"}

    selected_only: bpy.props.BoolProperty(name="Selected only", description="Look at the selected objects only")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Leave edit mode first")
            return False
        if any(item.type == "MESH" and not item.get("unisg_category") for item in context.scene.objects):
            return True
        cls.poll_message_set("All mesh objects of the scene have a category")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.read.scene_reader import read_scene
        from ..unisg_blender.errors import UniSGError
        from ..unisg_blender.predict.category_proposals import propose_categories

        settings = context.window_manager.unisg_meshes
        settings.proposals.clear()
        try:
            graph = read_scene(context.scene, details=False)
            rows = [row for row in range(len(graph)) if graph.category[row] < 0]
            if self.selected_only:
                selected = {item.name for item in context.selected_objects}
                rows = [row for row in rows if graph.name[row] in selected]
            found = propose_categories(graph, rows=rows)
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for proposal in sorted(found, key=lambda proposal: -proposal.confidence):
            item = settings.proposals.add()
            item.name, item.uid = proposal.name, proposal.uid
            for category, confidence in proposal.categories:
                guess = item.guesses.add()
                guess.name, guess.confidence = category, confidence
        self.report({"INFO"}, f"{len(found)} objects have proposed categories")
        return {"FINISHED"}


class UNISG_OT_accept_category(bpy.types.Operator):
    """Give the object this category"""

    bl_idname = "unisg.accept_category"
    bl_label = "Accept"
    bl_options = {"REGISTER", "UNDO"}

    uid: bpy.props.StringProperty(name="Identity", description="UniSG identity of the object")
    category: bpy.props.StringProperty(name="Category")

    def execute(self, context: bpy.types.Context) -> set[str]:
        if not accept(context, {self.uid: self.category}):
            self.report({"ERROR"}, "the object is no longer there, or is linked: propose again")
            return {"CANCELLED"}
        return {"FINISHED"}


class UNISG_OT_accept_categories(bpy.types.Operator):
    """Give all objects their most likely category, where its confidence is high enough"""

    bl_idname = "unisg.accept_categories"
    bl_label = "Accept All"
    bl_options = {"REGISTER", "UNDO"}

    threshold: bpy.props.FloatProperty(
        name="Confidence", description="Accept from here on", default=0.5, min=0, max=1, subtype="FACTOR"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if len(context.window_manager.unisg_meshes.proposals):
            return True
        cls.poll_message_set("Propose categories first")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        proposals = context.window_manager.unisg_meshes.proposals
        best = {item.uid: item.guesses[0] for item in proposals}
        wanted = {uid: guess.name for uid, guess in best.items() if guess.confidence >= self.threshold}
        total = len(proposals)
        self.report({"INFO"}, f"{accept(context, wanted)} of {total} objects got their category")
        return {"FINISHED"}


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
