"""Mesh features in Blender: encode, decode, find what is alike."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ..unisg_blender.errors import UniSGError
from .base import Operator

if TYPE_CHECKING:
    from ..unisg_blender.meshes.shape_feature import MeshFeature
    from ..unisg_blender.meshes.similar import Match
    from ..unisg_blender.scene.mesh import Mesh


def read_active(context: bpy.types.Context) -> Mesh:
    """The active object's mesh as it is seen, modifiers applied, in its own frame and the scene's unit."""
    from ..unisg_blender.blender.read.mesh_arrays import read_mesh

    item = context.active_object
    shown = item.evaluated_get(context.evaluated_depsgraph_get())
    try:
        return read_mesh(shown.to_mesh(), item.data.name)
    finally:
        shown.to_mesh_clear()


def active_in_metres(context: bpy.types.Context) -> Mesh:
    """The active object's mesh as :func:`read_active` gives it, to be compared with meshes from elsewhere."""
    from ..unisg_blender.blender.scene_units import metres_per_unit, scaled_mesh

    return scaled_mesh(read_active(context), metres_per_unit(context.scene))


class ActiveMesh(Operator):
    """Operators on the active object, which must be a mesh in object mode."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        if context.active_object is None or context.active_object.type != "MESH":
            return "Make a mesh object the active one"
        return "" if context.mode == "OBJECT" else "Leave edit mode first"


class UNISG_OT_encode_mesh(ActiveMesh):
    """Compute the 1024 numbers that describe the active object's shape, and keep them with its mesh"""

    bl_idname = "unisg.encode_mesh"
    bl_label = "Encode Mesh"

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        reason = super().why_grey(context)
        if not reason and context.active_object.data.library is not None:
            return "The mesh is linked from another file, which cannot be changed here"
        return reason

    def run(self, context: bpy.types.Context) -> None:
        """Encode and store."""
        from ..unisg_blender.meshes.feature_text import PROPERTY, feature_to_text
        from ..unisg_blender.meshes.shape_feature import default_encoder

        feature = default_encoder().encode([read_active(context)])[0]
        data = context.active_object.data
        data[PROPERTY] = feature_to_text(feature)
        self.report({"INFO"}, f"{data.name}: feature of {len(feature.vector)} numbers stored in {PROPERTY}")


class UNISG_OT_decode_mesh(ActiveMesh):
    """Make a new, closed mesh from the active object's feature (its shape is encoded first if it has none)"""

    bl_idname = "unisg.decode_mesh"
    bl_label = "Decode to Mesh"

    faces: bpy.props.IntProperty(name="Faces", description="Triangles of the new mesh", default=5000, min=4, max=200000)
    beside: bpy.props.BoolProperty(name="Beside", description="Put it next to the original, along x", default=True)

    def run(self, context: bpy.types.Context) -> None:
        """Decode into a new, active object."""
        from ..unisg_blender.blender.write.mesh_data import write_mesh
        from ..unisg_blender.meshes import decode_mesh

        source = context.active_object
        mesh = decode_mesh(self._feature(context), self.faces, name=f"{source.name} decoded")
        made = bpy.data.objects.new(mesh.name, write_mesh(mesh, {}))
        context.collection.objects.link(made)
        made.matrix_world = source.matrix_world
        if self.beside:
            made.matrix_world.translation.x += 1.2 * max(source.dimensions.x, 1e-3)
        for item in context.selected_objects:
            item.select_set(False)
        made.select_set(True)
        context.view_layer.objects.active = made
        self.report({"INFO"}, f"{made.name}: {len(made.data.polygons)} faces")

    def _feature(self, context: bpy.types.Context) -> MeshFeature:
        from ..unisg_blender.meshes.feature_text import PROPERTY, feature_from_text
        from ..unisg_blender.meshes.shape_feature import default_encoder

        text = context.active_object.data.get(PROPERTY)
        if isinstance(text, str):
            return feature_from_text(text)
        return default_encoder().encode([read_active(context)])[0]


class UNISG_OT_find_similar(ActiveMesh):
    """Find the objects of the scene, or the files of a folder, whose shape and size are most like the active object"""

    bl_idname = "unisg.find_similar"
    bl_label = "Find Similar"

    folder: bpy.props.StringProperty(
        name="Library", description="Folder of mesh files; empty: this scene", subtype="DIR_PATH"
    )
    count: bpy.props.IntProperty(name="Number", description="How many to find", default=5, min=1, max=100)
    use_size: bpy.props.BoolProperty(name="Size counts", description="Prefer assets of like size", default=True)

    def run(self, context: bpy.types.Context) -> None:
        """Search, fill the list of the panel, select what is in the scene."""
        found = self._search_folder(context) if self.folder else self._search_scene(context)
        if not found:
            raise UniSGError("there are no other meshes to compare with")
        settings = context.window_manager.unisg_meshes
        settings.matched = context.active_object.name
        settings.matches.clear()
        for match in found:
            item = settings.matches.add()
            item.name, item.distance = match.name, match.distance
        self.report({"INFO"}, f"most alike: {found[0].name} ({len(found)} found)")

    def _search_folder(self, context: bpy.types.Context) -> list[Match]:
        from ..unisg_blender.meshes.similar import folder_library

        library = folder_library(bpy.path.abspath(self.folder), skipped=lambda reason: self.report({"WARNING"}, reason))
        return library.nearest(active_in_metres(context), self.count, use_size=self.use_size)

    def _search_scene(self, context: bpy.types.Context) -> list[Match]:
        from ..unisg_blender.blender.read.scene_reader import read_scene
        from ..unisg_blender.meshes.similar import mesh_library

        active = context.active_object
        graph = read_scene(context.scene, details=False)
        rows = [row for row in range(len(graph)) if graph.mesh[row] >= 0 and graph.name[row] != active.name]
        library = mesh_library([graph.name[row] for row in rows], [graph.meshes[graph.mesh[row]] for row in rows])
        found = library.nearest(active_in_metres(context), self.count, use_size=self.use_size) if library.names else []
        for match in found:
            item = context.scene.objects.get(match.name)
            if item is not None and item.visible_get():
                item.select_set(True)
        return found


CLASSES = (UNISG_OT_encode_mesh, UNISG_OT_decode_mesh, UNISG_OT_find_similar)
