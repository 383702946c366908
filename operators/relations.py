"""Write into the scene which object stands on, in or beside which."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from .base import Operator

if TYPE_CHECKING:
    from ..unisg_blender.scene import SceneGraph

SHIPPED = "shipped"


class UNISG_OT_relations(Operator):
    """Compute relations from the geometry and keep them with the objects; relations of other kinds stay"""

    bl_idname = "unisg.relations"
    bl_label = "Find Relations"
    bl_options = {"REGISTER", "UNDO"}

    gap: bpy.props.FloatProperty(
        name="Gap (m)", description="Largest distance in metres at which surfaces touch", default=0.01, min=0, max=0.5
    )
    beside: bpy.props.FloatProperty(
        name="Beside (m)", description="Largest distance in metres of things beside each other", default=0.5, min=0
    )

    model: bpy.props.StringProperty(
        name="Model",
        description="Tell what is on top of what by this network ('shipped' for the one of the extension); "
        "empty: all relations by geometry",
        subtype="FILE_PATH",
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        if properties.model:
            return 'Have a network tell what is on top of what, seen as boxes; only "on top of" is replaced'
        return "Compute relations from the geometry and keep them with the objects; relations of other kinds stay"

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if any(item.type == "MESH" for item in context.scene.objects) else "The scene has no meshes"

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender import objects_by_uid, read_scene
        from ..unisg_blender.blender.authoring.identities import repair_identities
        from ..unisg_blender.scene.properties import RELATIONS, relations_of
        from ..unisg_blender.scene.relation import relations_to_json
        from ..unisg_blender.spatial.relation_tolerances import RelationTolerances
        from ..unisg_blender.spatial.relations import relate

        repair_identities(context.scene)  # relations name their targets by uid
        graph = read_scene(context.scene, details=False)
        tolerances = RelationTolerances(gap=self.gap, beside=self.beside)
        graph = _predicted(graph, self.model) if self.model else relate(graph, tolerances=tolerances)
        items = objects_by_uid(context.scene)
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


def _predicted(graph: SceneGraph, model: str) -> SceneGraph:
    from ..unisg_blender.predict.support_prediction import TopologyModel, with_supports

    path = None if model == SHIPPED else bpy.path.abspath(model)
    return with_supports(graph, TopologyModel(path).find(graph))


CLASSES = (UNISG_OT_relations,)
