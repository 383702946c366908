"""The steps of the guide's page of installing, done in a real window; each leaves its picture.

`make pictures` puts them where README.md and the guide show them.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from small_pictures import save_small

from tests.window.blender_window import BlenderWindow, blender_window, build_zip, missing_tools, window_folder

pytestmark = [pytest.mark.skipif(bool(missing_tools()), reason=missing_tools()), pytest.mark.slow]

SIZE = (780, 680)
"""Pixels of the window: three pictures of it stand side by side."""

WANTED = {
    "Armchair": 1, "Book": 8, "Bookshelf": 1, "Chair": 4, "Coffee Table": 1, "Cushion": 2, "Dining Table": 1,
    "Floor Lamp": 1, "Picture": 1, "Plant": 1, "Rug": 1, "Sofa": 1, "Television": 1, "Television Stand": 1,
}  # fmt: skip

ALONE = """
bpy.context.preferences.view.ui_scale = 0.85
bpy.ops.screen.screen_full_area(use_hide_panels=False)
"""

SHELL = """
import math, mathutils
for item in list(bpy.data.objects):
    bpy.data.objects.remove(item)
bpy.ops.unisg.add_room(kind="living-room", seed=11, with_view=False)
building = ("Floor", "Wall", "Door", "Window")
half = next(item for item in bpy.data.objects if item.get("unisg_category") == "Floor").dimensions / 2
for item in list(bpy.data.objects):
    x, y, z = item.matrix_world @ (sum(map(mathutils.Vector, item.bound_box), mathutils.Vector()) / 8)
    if item.get("unisg_category") not in building or max(x / half.x, -y / half.y) > 0.9:
        bpy.data.objects.remove(item)  # what is no building, and the walls that one would look through
space = area.spaces.active
space.overlay.show_relationship_lines, space.overlay.show_cursor = False, False
view = space.region_3d
view.view_perspective, view.view_location, view.view_distance = "PERSP", (1.9, 1.2, 0), 12.5
view.view_rotation = mathutils.Euler((math.radians(52), 0, math.radians(32))).to_quaternion()
bpy.ops.object.select_all(action="DESELECT")
bpy.context.view_layer.objects.active = None
result = len(bpy.data.objects)
"""
TAB = """
area.spaces.active.show_region_ui = True
sidebar = next(region for region in area.regions if region.type == "UI")
try:
    sidebar.active_panel_category = "UniSG"
except (TypeError, AttributeError):
    pass  # read-only before its first draw
result = sidebar.active_panel_category
"""
COUNTS = """
settings = bpy.context.window_manager.unisg
settings.seed = 1
for item in settings.counts:
    item.count = {wanted!r}.get(item.name, 0)
settings.active = 0
"""
GENERATE = """
settings, words = bpy.context.window_manager.unisg, {}
bpy.ops.unisg.generate("INVOKE_DEFAULT", True, model=settings.model_file(), seed=settings.seed,
    add=",".join(f"{name}={count}" for name, count in settings.wanted().items()))
"""


def keep(window: BlenderWindow, name: str) -> np.ndarray:
    """Keep what is on the screen as a picture (H, W, 3)."""
    screen = window.picture(name)
    folder = Path(os.environ.get("UNISG_PICTURES", "") or window.folder)
    save_small(Image.fromarray(screen.astype(np.uint8)), folder / f"{name}.png")
    return screen


@pytest.fixture(scope="module")
def window(tmp_path_factory: pytest.TempPathFactory) -> Iterator[BlenderWindow]:
    """A Blender as it is when it is started for the first time; the zip lies beside it."""
    folder, inside = window_folder(tmp_path_factory)
    build_zip(folder, inside)
    with blender_window(folder, inside, size=SIZE) as window:
        window.in_viewport(ALONE)
        yield window


def test_the_zip_is_dropped_the_tab_opened_and_a_room_furnished(window: BlenderWindow) -> None:
    window.move(390, 420)
    before = keep(window, "install-1")
    window.in_viewport(
        f"bpy.ops.extensions.package_install_files('INVOKE_DEFAULT', url='{window.inside}/extension.zip')"
    )
    assert (keep(window, "install-1") != before).any(axis=2).mean() > 0.05
    window.key("Return")
    window.wait("hasattr(bpy.types, 'UNISG_OT_generate')")

    window.in_viewport(SHELL)
    for _ in range(5):
        if window.in_viewport(TAB) == "UniSG":
            break
    window.run(
        "import sys; sys.modules['bl_ext.user_default.unisg_blender.operators.making.generation_settings']"
        ".choose_model(bpy.context, 'living_room')"
    )
    window.wait("bpy.context.window_manager.unisg.counts.get('Sofa')")
    window.move(300, 500)
    keep(window, "install-2")

    things = "sum('unisg_category' in item for item in bpy.data.objects)"
    count = window.run(COUNTS.format(wanted=WANTED) + f"result = {things}")
    window.in_viewport(GENERATE)
    window.wait(f"{things} > {count} and bpy.context.window.view_layer.objects.active")
    window.in_viewport("bpy.ops.object.select_all(action='DESELECT')")
    keep(window, "install-3")
    assert window.run(f"result = {things}") == count + sum(WANTED.values())
