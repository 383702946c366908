"""Tell what kind of scene it is."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

KINDS_OF: dict[str, str] = {}
"""What was said of each scene, by its name, for the panel."""


class UNISG_OT_classify(bpy.types.Operator):
    """Tell what kind of scene this is, by a trained network; nothing is changed"""

    bl_idname = "unisg.classify"
    bl_label = "What Kind of Scene?"
    bl_options = {"REGISTER"}

    model: bpy.props.StringProperty(
        name="Model", description="From 'unisg train classifier'; empty: the shipped one", subtype="FILE_PATH"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if len(context.scene.objects):
            return True
        cls.poll_message_set("The scene has no objects")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender import read_scene
        from ..unisg_blender.errors import UniSGError
        from ..unisg_blender.predict.scene_kind import SceneModel

        try:
            model = SceneModel(bpy.path.abspath(self.model) if self.model else None)
            chances = model.classify(read_scene(context.scene, details=False))
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        text = ", ".join(f"{name} {value:.0%}" for name, value in chances.items())
        KINDS_OF[context.scene.name] = text
        self.report({"INFO"}, text)
        return {"FINISHED"}


@persistent
def _loaded(*_: object) -> None:
    KINDS_OF.clear()  # another file's scenes have the same names


CLASSES = (UNISG_OT_classify,)


def register() -> None:
    """Forget what was said when another file is opened."""
    bpy.app.handlers.load_post.append(_loaded)


def unregister() -> None:
    """Stop that."""
    bpy.app.handlers.load_post.remove(_loaded)
