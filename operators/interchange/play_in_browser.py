"""The scene and its lesson in this machine's browser, served while Blender runs."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import bpy

from ..base import Operator, redraw_views
from ..window_wording import in_window

if TYPE_CHECKING:
    from ...unisg_blender.web.local_server import LocalServer

_served: list[tuple[LocalServer, TemporaryDirectory[str]]] = []


def served_address() -> str:
    """Where the page is shown, "" for nowhere."""
    return _served[0][0].address if _served else ""


class UNISG_OT_play_in_browser(Operator):
    """Show the scene in this machine's browser and play its lesson there; pressed again, what has changed is shown"""

    bl_idname = "unisg.play_in_browser"
    bl_label = "Play in Browser"

    open_browser: bpy.props.BoolProperty(
        name="Open the Browser", description="Otherwise the address is only told", default=True, options={"SKIP_SAVE"}
    )

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if context.scene.objects else "The scene is empty"

    def run(self, context: bpy.types.Context) -> None:
        from ...unisg_blender.blender import ReadReport, read_scene
        from ...unisg_blender.web.site import write_site

        lost, window, fresh = ReadReport(), context.window, not _served
        if window is not None:
            window.cursor_set("WAIT")
        try:
            graph = read_scene(context.scene, report=lost)
            lost.extend(write_site(graph, _folder()))
        except Exception:
            if fresh:
                unregister()
            raise
        finally:
            if window is not None:
                window.cursor_set("DEFAULT")
        if len(lost):
            self.report({"WARNING"}, in_window(f"Not represented: {lost.summary(most=3)}"))
        self.report({"INFO"}, f"Shown at {served_address()}")
        if self.open_browser and not bpy.app.background:
            bpy.ops.wm.url_open(url=served_address())
        redraw_views(context)


class UNISG_OT_browser_stop(Operator):
    """Stop showing the scene in the browser"""

    bl_idname = "unisg.browser_stop"
    bl_label = "Stop Showing"
    bl_options = {"INTERNAL"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if _served else "Nothing is shown in a browser"

    def run(self, context: bpy.types.Context) -> None:
        unregister()
        redraw_views(context)


def _folder() -> Path:
    """The folder that is served; it begins to be where it is not."""
    from ...unisg_blender.web.local_server import LocalServer

    if not _served:
        folder = TemporaryDirectory(prefix="unisg-page-")
        _served.append((LocalServer(Path(folder.name)), folder))
    return _served[0][0].folder


CLASSES = (UNISG_OT_play_in_browser, UNISG_OT_browser_stop)


def unregister() -> None:
    """Stop serving, and take away what was served."""
    while _served:
        server, folder = _served.pop()
        server.close()
        folder.cleanup()
