"""Tell what kind of scene it is."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from .base import Operator

KINDS_OF: dict[str, list[str]] = {}
"""What was said of each scene, by its name, for the panel."""


class UNISG_OT_classify(Operator):
    """Tell what kind of scene this is, by a trained network; nothing is changed"""

    bl_idname = "unisg.classify"
    bl_label = "What Kind of Scene?"
    bl_options = {"REGISTER"}

    model: bpy.props.StringProperty(
        name="Model", description="From 'unisg train classifier'; empty: the shipped one", subtype="FILE_PATH"
    )

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if len(context.scene.objects) else "The scene has no objects"

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender import read_scene
        from ..unisg_blender.predict.scene_kind import SceneModel

        model = SceneModel(bpy.path.abspath(self.model) if self.model else None)
        lines = model.classify(read_scene(context.scene, details=False)).lines
        KINDS_OF[context.scene.name] = lines
        self.report({"INFO"}, "; ".join(lines))


@persistent
def _loaded(*_: object) -> None:
    KINDS_OF.clear()  # another file's scenes have the same names


CLASSES = (UNISG_OT_classify,)
HANDLERS = (("load_post", _loaded),)
