"""Write into the scene which thing stands on, in or beside which."""

from __future__ import annotations

import bpy

NAME_OF: dict[str, str] = {}
"""Names of the objects by uid when relations were last computed, for the panel."""


class UNISG_OT_relations(bpy.types.Operator):
    """Compute relations from the geometry and keep them with the objects; relations of other kinds stay"""

    bl_idname = "unisg.relations"
    bl_label = "Find Relations"
    bl_options = {"REGISTER", "UNDO"}

    gap: bpy.props.FloatProperty(
        name="Gap", description="Largest distance at which surfaces touch", default=0.01, min=0, subtype="DISTANCE"
    )
    beside: bpy.props.FloatProperty(
        name="Beside",
        description="Largest distance of things beside each other",
        default=0.5,
        min=0,
        subtype="DISTANCE",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if any(item.type == "MESH" for item in context.scene.objects):
            return True
        cls.poll_message_set("The scene has no meshes")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender import objects_by_uid, read_scene
        from ..unisg_blender.blender.identity import repair_identities
        from ..unisg_blender.scene.properties import RELATIONS, relations_of
        from ..unisg_blender.scene.relate import RelationTolerances, relate
        from ..unisg_blender.scene.relations import relations_to_json

        repair_identities(context.scene)  # relations name their targets by uid
        graph = relate(read_scene(context.scene), RelationTolerances(gap=self.gap, beside=self.beside))
        items = objects_by_uid(context.scene)
        NAME_OF.clear()
        NAME_OF.update(zip(graph.uid, graph.name, strict=True))
        count = 0
        for row, uid in enumerate(graph.uid):
            item, found = items.get(uid), relations_of(graph, row)
            if item is None or item.library is not None:
                continue
            if found:
                item[RELATIONS] = relations_to_json(found)
                count += len(found)
            elif RELATIONS in item:
                del item[RELATIONS]
        self.report({"INFO"}, f"{count} relations")
        return {"FINISHED"}


CLASSES = (UNISG_OT_relations,)
