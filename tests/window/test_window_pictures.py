"""What pages show of Blender's window, done there: the steps of installing, the tab, a lesson, placing, the building.

Each leaves its picture; `make pictures` puts them where the pages show them.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from small_pictures import save_small

from tests.window.blender_window import PATIENCE, BlenderWindow, blender_window, build_zip, missing_tools, window_folder

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
space.overlay.show_relationship_lines, space.overlay.show_cursor, space.show_region_hud = False, False, False
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


CLEAR = """
import math, mathutils
for item in list(bpy.data.objects):
    bpy.data.objects.remove(item)
space = area.spaces.active
space.overlay.show_relationship_lines, space.overlay.show_cursor, space.show_region_hud = False, False, False

def look(place, distance, down, around):
    view = space.region_3d
    view.view_perspective, view.view_location, view.view_distance = "PERSP", place, distance
    view.view_rotation = mathutils.Euler((math.radians(down), 0, math.radians(around))).to_quaternion()
    bpy.ops.object.select_all(action="DESELECT")
    bpy.context.view_layer.objects.active = None
"""
OPERATING_ROOM = """
bpy.ops.unisg.add_room(kind="operating-room", seed=7, with_view=False)
for item in list(bpy.data.objects):
    corners = [item.matrix_world @ mathutils.Vector(corner) for corner in item.bound_box]
    near = min(at.x for at in corners) > 1.5 or max(at.y for at in corners) < -1.5
    if near and item.get("unisg_category") in ("Wall", "Door", "Window"):
        item.hide_set(True)  # one would look through it
look((1.6, 0, 0), 13, 48, 30)
"""
LIVING_ROOM = """
bpy.ops.unisg.add_room(kind="living-room", seed=5, with_view=False)
look((0, 0, 0.4), 9.5, 38, 20)
"""
TRAY = """
bpy.ops.mesh.primitive_cylinder_add(radius=0.5, depth=0.2, location=(0.9, 0, 0.1))
tray = bpy.context.object
bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0.9, 0, 0.45))
box = bpy.context.object
tray.name, box.name = "Tray", "Box"
bpy.ops.unisg.action_add(type="Insert")
bpy.context.window_manager.unisg_pick_frame = tray
bpy.ops.unisg.action_reference()
box.location = (-0.4, 0.2, 0.25)
bpy.ops.unisg.lesson_new(name="Serve")
bpy.context.view_layer.objects.active = box
if bpy.ops.unisg.lesson_add_action.poll():
    bpy.ops.unisg.lesson_add_action()
look((0.9, 0, 0), 4.5, 60, 25)
bpy.context.view_layer.objects.active = box
box.select_set(True)
"""
LESSON = "__import__('sys').modules['bl_ext.user_default.unisg_blender.operators.play'].session()"
SESSION = "__import__('sys').modules['bl_ext.user_default.unisg_blender.operators.placing.placing_session'].placing()"
LOOKING = "__import__('sys').modules['bl_ext.user_default.unisg_blender.operators.room.recognised']"


def scroll(window: BlenderWindow, times: int) -> None:
    """Turn the wheel over the sidebar, down or (less than nothing) up."""
    window.move(751, 300)  # beside the lists, which would turn instead
    for _ in range(abs(times)):
        window.click(5 if times > 0 else 4)
    window.move(300, 650)


def keep(window: BlenderWindow, name: str, unlike: np.ndarray | None = None) -> np.ndarray:
    """Keep what is on the screen as a picture (H, W, 3), as soon as it stays and is unlike another by a twentieth."""
    last, end = window.picture(name), time.monotonic() + PATIENCE
    while True:
        screen = window.picture(name)
        if (screen == last).all() and (unlike is None or (screen != unlike).any(axis=2).mean() > 0.05):
            break
        assert time.monotonic() < end, f"{name} never looks as it should"
        last = screen
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
    keep(window, "install-1", unlike=before)
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


def test_an_action_is_authored(window: BlenderWindow) -> None:
    window.in_viewport(CLEAR + TRAY)
    window.wait("any('unisg_lsa' in item for item in bpy.data.objects)")
    scroll(window, 9)
    keep(window, "behaviour-authoring")
    scroll(window, -12)


def test_the_tab_says_what_is_missing(window: BlenderWindow) -> None:
    window.in_viewport(CLEAR + OPERATING_ROOM + "bpy.ops.unisg.suggest()")
    window.wait("bpy.context.window_manager.unisg_suggested.things")
    keep(window, "sidebar")


def test_a_lesson_is_played(window: BlenderWindow) -> None:
    window.in_viewport(CLEAR + OPERATING_ROOM + "bpy.ops.unisg.play('INVOKE_DEFAULT')")
    window.wait(LESSON)
    scroll(window, 14)
    keep(window, "behaviour-playing")
    window.key("Escape")
    window.wait(f"not {LESSON}")


def test_the_building_is_shown(window: BlenderWindow) -> None:
    window.in_viewport(CLEAR + LIVING_ROOM + "area.spaces.active.show_region_ui = False")
    before = keep(window, "building")
    window.run("bpy.context.window_manager.unisg_structure_shown = True")
    window.wait(f"{LOOKING}.recognised(bpy.context.scene) and not {LOOKING}.looking()")
    keep(window, "building", unlike=before)
    window.run("bpy.context.window_manager.unisg_structure_shown = False")


def test_a_picture_is_placed(window: BlenderWindow) -> None:
    window.in_viewport(CLEAR + LIVING_ROOM + "area.spaces.active.show_region_ui = False")
    window.move(400, 300)
    window.in_viewport("bpy.ops.unisg.place('INVOKE_DEFAULT', category='Picture', model='living_room')")
    window.wait(f"{SESSION} and {SESSION}.room")
    window.move(330, 250)
    window.wait(f"{SESSION}.ghost")
    keep(window, "placing")
    window.key("Escape")
