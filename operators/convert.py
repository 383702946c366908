"""The scene as a file through the scenegraph, and a master file as a scene."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import bpy
from bpy.app.handlers import persistent

from ..unisg_blender.errors import UniSGError
from ..unisg_blender.runtime.file_endings import JSON, USD, is_of
from .base import RELATIVE, FileOperator
from .window_wording import in_window

if TYPE_CHECKING:
    from ..unisg_blender.runtime.read_report import ReadReport
    from ..unisg_blender.scene import SceneGraph

ENDINGS = (*USD, *JSON)

DRAWN = 0.1
"""Seconds after which a window that shows another scene has been drawn."""

_waiting: list[tuple[str, int, str]] = []
"""Scenes by name, the windows that are to show them, and what the undo step is called."""

_shown: set[str] = set()
"""Scenes by name that were shown behind a file browser."""


def show_scene(operator: FileOperator, context: bpy.types.Context, graph: SceneGraph, lost: ReadReport) -> None:
    """Put a scenegraph into a scene of its own, look at that, and tell what of it, and of its file, got lost."""
    from ..unisg_blender.blender import ReadReport, write_scene

    report = ReadReport()
    scene = write_scene(graph, report=report)
    _look_at(scene, context.window, operator.bl_label, operator.browsed)
    report.extend(lost)
    if len(report):
        operator.report({"WARNING"}, in_window(f"Not represented: {report.summary(most=3)}"))
    operator.report({"INFO"}, f"{len(graph)} entities in the scene {scene.name!r}")


def _look_at(scene: bpy.types.Scene, window: bpy.types.Window | None, step: str, later: bool) -> None:
    """Show a scene in a window and make an undo step of it, which keeps what each window shows.

    ``later`` if a file browser is closing; Blender lays the top bar out for that browser's width then, and loses it if
    the name of the scene is longer: when it has been drawn, the bars are laid out anew.
    """
    _waiting[:] = [(scene.name, window.as_pointer(), step)] if window is not None else []
    if not later:
        _look_now()
        return
    _shown.add(scene.name)
    if not bpy.app.timers.is_registered(_look_then):
        bpy.app.timers.register(_look_then, first_interval=0.01)


def _look_now() -> None:
    for name, pointer, step in _waiting:
        for window in bpy.context.window_manager.windows:
            if window.as_pointer() == pointer and name in bpy.data.scenes:
                window.scene = bpy.data.scenes[name]
                _bring_into_view(window)
                bpy.ops.ed.undo_push(message=step)
    _waiting.clear()


def _bring_into_view(window: bpy.types.Window) -> None:
    """Have the viewports of a window show all of its scene: it may lie where nobody looks, or be much larger."""
    for area in window.screen.areas:
        region = next((each for each in area.regions if each.type == "WINDOW"), None)
        if area.type == "VIEW_3D" and region is not None:
            with bpy.context.temp_override(window=window, area=area, region=region):
                bpy.ops.view3d.view_all()


def _look_then() -> float | None:
    """Show what waits; when that has been drawn, lay the bars of all windows out anew."""
    if _waiting:
        _look_now()
        return DRAWN
    for window in bpy.context.window_manager.windows:
        shown = window.screen.show_statusbar
        window.screen.show_statusbar = not shown
        window.screen.show_statusbar = shown
    return None


@persistent
def _undone(*_: object) -> None:
    """A step back or forth may show a scene with a longer name: the same as behind the file browser."""
    if _shown and not bpy.app.timers.is_registered(_look_then):
        bpy.app.timers.register(_look_then, first_interval=DRAWN)


class UNISG_OT_convert(FileOperator):
    """Save the scene through the scenegraph: as a USD master file (.usda, .usdc, .usdz) or as .json"""

    bl_idname = "unisg.convert"
    bl_label = "Save Master File"
    bl_options = {"REGISTER"}

    filepath: bpy.props.StringProperty(name="File", subtype="FILE_PATH", options=RELATIVE, default="//scene.usdc")
    filter_glob: bpy.props.StringProperty(default=";".join(f"*{ending}" for ending in ENDINGS), options={"HIDDEN"})
    check_existing: bpy.props.BoolProperty(
        name="Check Existing", description="Warn before a file is replaced", default=True, options={"HIDDEN"}
    )
    animation: bpy.props.BoolProperty(
        name="Animation", description="Step through the scene's frames and keep how its objects move", default=True
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if not self.properties.is_property_set("filepath"):
            self.filepath = f"//{Path(bpy.data.filepath).stem or 'scene'}{_usual_ending()}"
        return super().invoke(context, event)

    def check(self, context: bpy.types.Context) -> bool:
        """Blender asks this whenever a name was typed, and warns of the file that would be replaced."""
        typed, self.filepath = self.filepath, _with_ending(self.filepath)
        return typed != self.filepath

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender import ReadReport, read_scene
        from ..unisg_blender.formats.scene_files import write_scene_file

        path = Path(bpy.path.abspath(_with_ending(self.filepath)))
        report, manager = ReadReport(), context.window_manager
        if path.suffix.lower() == ".blend":
            raise UniSGError("what is open is a .blend already: File > Save a Copy; here a file ends in .usdc, ...")
        if not is_of(path, ENDINGS):
            raise UniSGError(f"a converted scene ends in {', '.join(ENDINGS)}")
        manager.progress_begin(0, 1)
        try:
            graph = read_scene(context.scene, animation=self.animation, report=report)
            write_scene_file(graph, path, lambda done, total: manager.progress_update(done / total))
        finally:
            manager.progress_end()
        if len(report):
            self.report({"WARNING"}, in_window(f"Not represented: {report.summary(most=3)}"))
        self.report({"INFO"}, f"Saved {path.name}")


def _usual_ending() -> str:
    """The ending of a master file: JSON where this Blender offers no USD."""
    from ..unisg_blender.usd.pxr_library import missing_pxr

    return ".json" if missing_pxr() else ".usdc"


def _with_ending(path: str) -> str:
    """A path with the usual ending where its name has none; a mere folder stays as it is."""
    return path if bpy.path.basename(path) == "" or Path(path).suffix else f"{path}{_usual_ending()}"


class UNISG_OT_open_master_file(FileOperator):
    """Open a USD file or a scene saved as .json in a scene of its own, behaviour and relations included"""

    bl_idname = "unisg.open_master_file"
    bl_label = "Open Master File"
    bl_options = {"REGISTER"}  # the undo step is made when the scene is shown

    filter_glob: bpy.props.StringProperty(default=";".join(f"*{ending}" for ending in ENDINGS), options={"HIDDEN"})

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.formats.scene_files import read_scene_file

        path = Path(bpy.path.abspath(self.filepath))
        if not is_of(path, ENDINGS):
            raise UniSGError(f"a master file ends in {', '.join(ENDINGS)}")
        show_scene(self, context, *read_scene_file(path))


CLASSES = (UNISG_OT_convert, UNISG_OT_open_master_file)
HANDLERS = (("undo_post", _undone), ("redo_post", _undone))


def unregister() -> None:
    """Forget what was to be shown."""
    _waiting.clear()
    _shown.clear()
    if bpy.app.timers.is_registered(_look_then):
        bpy.app.timers.unregister(_look_then)
