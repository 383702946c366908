"""Save the scene as a USD master file, or as .blend or .json, through the scenegraph."""

from __future__ import annotations

from pathlib import Path

import bpy

ENDINGS = (".usda", ".usdc", ".usdz", ".usd", ".json", ".blend")


class UNISG_OT_convert(bpy.types.Operator):
    """Save the scene through the scenegraph as .usda, .usdc, .usdz, .json or .blend; the ending says which"""

    bl_idname = "unisg.convert"
    bl_label = "Convert Scene"
    bl_options = {"REGISTER"}

    filepath: bpy.props.StringProperty(name="File", subtype="FILE_PATH", default="//scene.usdc")
    filter_glob: bpy.props.StringProperty(default=";".join(f"*{ending}" for ending in ENDINGS), options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender import ReadReport, read_scene, save_blend
        from ..unisg_blender.commands.scene_files import write_scene_file
        from ..unisg_blender.errors import UniSGError

        path = Path(bpy.path.abspath(self.filepath))
        report = ReadReport()
        try:
            if path.suffix.lower() not in ENDINGS:
                raise UniSGError(f"a converted scene ends in {', '.join(ENDINGS)}")
            if path.suffix.lower() == ".blend":
                save_blend(path)  # what is open, as it is: nothing of the user's is replaced
            else:
                write_scene_file(read_scene(context.scene, report=report), path)
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if len(report):
            self.report({"WARNING"}, f"Not represented: {report.summary()}")
        self.report({"INFO"}, f"Saved {path.name}")
        return {"FINISHED"}


CLASSES = (UNISG_OT_convert,)
