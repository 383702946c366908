"""Rooms and meshes of other programs, from the menu File > Import or dropped into a viewport."""

from __future__ import annotations

from pathlib import Path

import bpy

from ...unisg_blender.errors import UniSGError
from ...unisg_blender.runtime.file_endings import JSON, LAYOUTS, MESHES, is_of
from ..base import FileOperator
from ..convert import show_scene

ENDINGS = (*JSON, *LAYOUTS, *MESHES)
DROPPED = (".jsonl", ".gz", ".world", ".sdf", ".urdf", ".mjcf", ".dae", ".off", ".3mf")
"""Endings of files that Blender itself does not take when they are dropped; of two dots it looks at the last."""

NAME = "Rooms of Other Programs (UniSG)"


class UNISG_OT_import_layout(FileOperator):
    """Import a room of ProcTHOR, Holodeck, AI2-THOR, Habitat, SceneEval, SAGE, 3D-FRONT, Gazebo, MuJoCo and others"""

    bl_idname = "unisg.import_layout"
    bl_label = "Import Rooms"
    bl_options = {"REGISTER"}  # the undo step is made when the scene is shown

    filter_glob: bpy.props.StringProperty(default=";".join(f"*{ending}" for ending in ENDINGS), options={"HIDDEN"})
    assets: bpy.props.StringProperty(
        name="Meshes", description="Folder with the meshes of what the room places; boxes without", subtype="DIR_PATH"
    )
    scene: bpy.props.StringProperty(
        name="Scene", description="Of a file with several rooms: name or number of one, from 0; the first when empty",
        options={"SKIP_SAVE"},
    )  # fmt: skip

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if self.filepath and Path(self.filepath).is_file():  # it was dropped
            return self.execute(context)
        return super().invoke(context, event)

    def run(self, context: bpy.types.Context) -> None:
        from ...unisg_blender.formats.scene_files import read_scene_file

        path, manager = Path(bpy.path.abspath(self.filepath)), context.window_manager
        if not is_of(path, ENDINGS):
            raise UniSGError(f"a room of another program ends in {', '.join(ENDINGS)}")
        assets = Path(bpy.path.abspath(self.assets)) if self.assets else None
        manager.progress_begin(0, 1)
        try:
            graph, lost = read_scene_file(
                path,
                lambda done, total: manager.progress_update(done / max(total, 1)),
                scene="" if is_of(path, MESHES) else self.scene,
                assets=assets,
            )
        finally:
            manager.progress_end()
        show_scene(self, context, graph, lost)


CLASSES: tuple[type, ...] = (UNISG_OT_import_layout,)

if hasattr(bpy.types, "FileHandler"):

    class UNISG_FH_layout(bpy.types.FileHandler):
        """Takes files that are dropped into a viewport."""

        bl_idname = "UNISG_FH_layout"
        bl_label = NAME
        bl_import_operator = "unisg.import_layout"
        bl_file_extensions = ";".join(DROPPED)

        @classmethod
        def poll_drop(cls, context: bpy.types.Context) -> bool:
            return context.area is not None and context.area.type in ("VIEW_3D", "OUTLINER")

    CLASSES = (*CLASSES, UNISG_FH_layout)


def _draw_entry(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.operator(UNISG_OT_import_layout.bl_idname, text=NAME)


def register() -> None:
    """Put the entry into File > Import."""
    bpy.types.TOPBAR_MT_file_import.append(_draw_entry)


def unregister() -> None:
    """Take it away."""
    bpy.types.TOPBAR_MT_file_import.remove(_draw_entry)
