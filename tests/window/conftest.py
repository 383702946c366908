"""A Blender in a window into which the zip was installed, once for each file of tests, and a room in it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.window.blender_window import BlenderWindow, blender_window, install, window_folder

ROOM = """
import math, mathutils
for scene in bpy.data.scenes[1:]:
    bpy.data.scenes.remove(scene)
for item in list(bpy.data.objects):
    bpy.data.objects.remove(item)
bpy.ops.unisg.add_room(kind="living-room", seed=5, with_view=False)
bpy.context.window_manager.unisg.listed = ""
for item in bpy.data.objects:
    if item.type == "EMPTY":
        item.hide_set(True)
space = area.spaces.active
space.show_region_ui, space.overlay.show_relationship_lines = False, False
view = space.region_3d
view.view_perspective, view.view_location, view.view_distance = "PERSP", (0, 0, 0.4), 7.5
view.view_rotation = mathutils.Euler((math.radians(38), 0, math.radians(20))).to_quaternion()
bpy.ops.ed.undo_push(message="A room")
result = len(bpy.data.objects)
"""


@pytest.fixture(scope="module")
def window(tmp_path_factory: pytest.TempPathFactory) -> Iterator[BlenderWindow]:
    """A Blender into which the zip was installed."""
    folder, inside = window_folder(tmp_path_factory)
    install(folder, inside)
    with blender_window(folder, inside) as window:
        yield window


@pytest.fixture
def room(window: BlenderWindow) -> int:
    """A living room in the window; how many objects it has."""
    window.key("Escape")
    return int(window.in_viewport(ROOM))
