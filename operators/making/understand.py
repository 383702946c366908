"""Tell what a model knows of the scene: its things in the model's words, and how foreign it is."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from ..base import Operator
from .generation_settings import load_generator, read_words, scene_in_words

UNDERSTOOD: dict[str, list[str]] = {}
"""What was said of each scene, by its name, for the panel."""


class UNISG_OT_understand(Operator):
    """Tell which things of the scene the model knows, and as what it takes them; nothing is changed"""

    bl_idname = "unisg.understand"
    bl_label = "What Is Known Here?"
    bl_options = {"REGISTER"}

    model: bpy.props.StringProperty(name="Model", description="ONNX file or name of a shipped model")
    words: bpy.props.StringProperty(
        name="Words", description="JSON or TOML: what words for things mean", subtype="FILE_PATH"
    )

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if len(context.scene.objects) else "The scene has no objects"

    def run(self, context: bpy.types.Context) -> None:
        mapping = read_words(self.words)
        reading = load_generator(self.model).read(scene_in_words(context.scene, mapping), mapping.get("words", {}))
        lines = reading.report_lines()
        UNDERSTOOD[context.scene.name] = lines
        self.report({"INFO"}, lines[0])


@persistent
def _loaded(*_: object) -> None:
    UNDERSTOOD.clear()  # another file's scenes have the same names


CLASSES = (UNISG_OT_understand,)
HANDLERS = (("load_post", _loaded),)
