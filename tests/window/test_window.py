"""The extension in a real Blender window, as a user meets it: installed from its zip, clicked, and looked at."""

from __future__ import annotations

import numpy as np
import pytest

from tests.window.blender_window import SIZE, BlenderWindow, missing_tools

pytestmark = [pytest.mark.skipif(bool(missing_tools()), reason=missing_tools()), pytest.mark.slow]

SESSION = "__import__('sys').modules['bl_ext.user_default.unisg_blender.operators.placing.placing_session'].placing()"
LESSON = "__import__('sys').modules['bl_ext.user_default.unisg_blender.operators.play'].session()"
COUNT = "result = len(bpy.data.objects)"
VIEWPORT = np.s_[90:700, 60:1050]
"""Rows and columns of the picture that the viewport fills, its edges left out."""


def begin(window: BlenderWindow, category: str) -> None:
    """Begin to place something, and wait until it is known where."""
    window.move(500, 420)
    window.in_viewport(f"bpy.ops.unisg.place('INVOKE_DEFAULT', category={category!r}, model='living_room')")
    window.wait(f"{SESSION} and {SESSION}.room")


def changed(before: np.ndarray, after: np.ndarray) -> float:
    """Share of the viewport that has changed."""
    return float((np.abs(after - before)[VIEWPORT].max(axis=2) > 12).mean())


def warm(picture: np.ndarray) -> float:
    """Share of the viewport that is coloured like a likely place: yellow to red."""
    red, green, blue = np.moveaxis(picture[VIEWPORT], 2, 0)
    return float(((red > 170) & (red - blue > 70) & (green < red)).mean())


def test_the_room_glows_and_a_click_places(window: BlenderWindow, room: int) -> None:
    before = window.picture("room")
    assert before.shape == (SIZE[1], SIZE[0], 3)
    assert before[VIEWPORT].std() > 10
    begin(window, "Cup")
    window.move(450, 420)
    glowing = window.picture("placing-cup")
    assert warm(glowing) > warm(before) + 0.005
    assert 0.01 < changed(before, glowing) < 0.5
    assert window.run(f"result = {SESSION}.lines()")[0].startswith("Cup: ")
    window.click()
    window.wait(f"len(bpy.data.objects) == {room + 1}")
    after = window.picture("placed-cup")
    assert warm(after) < warm(before) + 0.005
    assert not window.run(f"result = bool({SESSION})")
    window.in_viewport("for _ in range(50):\n    bpy.ops.ed.undo()\n    bpy.ops.ed.redo()")
    assert window.run(COUNT) == room + 1
    window.key("ctrl+z")
    window.wait(f"len(bpy.data.objects) == {room}")


def test_one_after_another_each_is_a_step_of_undo_and_esc_leaves(window: BlenderWindow, room: int) -> None:
    begin(window, "Plant")
    for number in range(2):
        window.move(500 + 40 * number, 400)
        window.wait(f"{SESSION}.ghost")
        window.click(shift=True)
        window.wait(f"len(bpy.data.objects) > {room + number} and {SESSION}.room")
    window.key("ctrl+z")
    window.wait(f"{SESSION} and {SESSION}.room and len(bpy.data.objects) == {room + 1}")
    window.move(470, 380)
    first = window.run(f"result = list({SESSION}.ghost.place)")
    window.click(5)
    assert window.run(f"result = list({SESSION}.ghost.place)") != first
    window.click(5, shift=True)
    assert window.run(f"result = {SESSION}.yaw") is not None
    window.key("l")
    assert "locked" in window.run(f"result = {SESSION}.lines()")
    window.key("Escape")
    assert not window.run(f"result = bool({SESSION})")
    assert window.run(COUNT) == room + 1


def test_f3_finds_it_and_asks_what(window: BlenderWindow, room: int) -> None:
    window.move(500, 420)
    window.key("F3")
    window.type("Place...")
    window.wait("bpy.context.window_manager.unisg is not None")
    window.picture("choose")
    window.type("Book")
    window.wait(f"{SESSION}")
    assert window.run(f"result = {SESSION}.choice.category") in ("Book", "Bookshelf")
    window.key("Escape")


def test_generate_reroll_settle_and_undo(window: BlenderWindow, room: int) -> None:
    before = window.picture("before-generate")
    window.in_viewport(
        "bpy.ops.unisg.generate('INVOKE_DEFAULT', True, add='Chair=1,Plant=2', model='living_room', seed=3)"
    )
    window.wait(f"len(bpy.data.objects) > {room}")
    window.wait("not bpy.context.window.modal_operators")
    assert 0 < changed(before, window.picture("generated")) < 0.3
    name, place = window.run(
        "item = bpy.context.active_object; result = [item.name, list(item.matrix_world.translation)]"
    )
    window.in_viewport(
        f"bpy.ops.object.select_all(action='DESELECT'); bpy.data.objects[{name!r}].select_set(True)\n"
        "bpy.ops.unisg.reroll('INVOKE_DEFAULT', True, model='living_room', seed=4)"
    )
    window.wait("not bpy.context.window.modal_operators")
    window.wait(f"list(bpy.data.objects[{name!r}].matrix_world.translation) != {place!r}")
    raised = window.in_viewport(
        f"item = bpy.data.objects[{name!r}]; item.matrix_world.translation.z += 0.5\n"
        "bpy.context.view_layer.update(); high = item.matrix_world.translation.z\n"
        "bpy.ops.unisg.settle('INVOKE_DEFAULT', True)\nbpy.context.view_layer.update()\n"
        "result = high - item.matrix_world.translation.z"
    )
    assert raised > 0.3
    for _ in range(6):
        window.key("ctrl+z")
        if window.run(COUNT) == room:
            break
    assert window.run(COUNT) == room


def test_a_lesson_is_authored_and_played(window: BlenderWindow, room: int) -> None:
    window.in_viewport("""
cup = next(item for item in bpy.data.objects if item.get("unisg_category") == "Cup")
table = cup.parent
bpy.ops.object.select_all(action="DESELECT")
cup.select_set(True)
bpy.context.view_layer.objects.active = cup
for item in [item for item in bpy.data.objects if "unisg_lsa" in item]:
    bpy.data.objects.remove(item)
bpy.ops.unisg.action_add(type="Insert")
bpy.context.window_manager.unisg_pick_frame = table
bpy.ops.unisg.action_reference()
cup.location.x += 0.3
bpy.ops.unisg.lesson_new(name="Serve")
if bpy.ops.unisg.lesson_add_action.poll():
    bpy.ops.unisg.lesson_add_action()
bpy.context.view_layer.objects.active = cup
bpy.ops.unisg.play("INVOKE_DEFAULT")
""")
    window.wait(f"{LESSON}")
    assert not window.run(f"result = {LESSON}.state.finished")
    window.picture("lesson-open")
    window.run("bpy.context.view_layer.objects.active.location.x -= 0.3")
    window.wait(f"not {LESSON} or {LESSON}.state.finished")
    window.picture("lesson-done")
    window.key("Escape")


def test_switched_off_and_on_while_placing_nothing_stays(window: BlenderWindow, room: int) -> None:
    kinds = ("undo_post", "redo_post", "load_pre", "load_post", "depsgraph_update_post")
    handlers = f"result = [len(getattr(bpy.app.handlers, name)) for name in {kinds!r}]"
    before = window.run(handlers)
    begin(window, "Chair")
    for _ in range(20):
        window.run("import addon_utils; addon_utils.disable('bl_ext.user_default.unisg_blender')")
        window.run("import addon_utils; addon_utils.enable('bl_ext.user_default.unisg_blender')")
    assert window.run(handlers) == before
    assert not window.run(f"result = bool({SESSION})")


def test_shapes_of_a_library_are_found_by_a_blender_of_its_own(window: BlenderWindow, room: int) -> None:
    (window.folder / "library").mkdir(exist_ok=True)
    window.run(f"""
for item in list(bpy.context.preferences.filepaths.asset_libraries):
    bpy.ops.preferences.asset_library_remove(index=0)
bpy.ops.preferences.asset_library_add(directory={window.inside!r} + "/library")
bpy.context.preferences.filepaths.asset_libraries[0].name = "Window"
mesh = bpy.data.meshes.new("Pot")
mesh.from_pydata([(-.2, -.2, 0), (.2, -.2, 0), (.2, .2, 0), (-.2, .2, 0), (0, 0, .9)], [],
    [(3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])
pot = bpy.data.objects.new("Pot", mesh)
pot["unisg_category"] = "Plant"
pot.asset_mark()
bpy.data.libraries.write({window.inside!r} + "/library/pots.blend", {{pot}})
bpy.data.objects.remove(pot)
bpy.data.meshes.remove(mesh)
""")
    window.in_viewport("bpy.ops.unisg.look_through_libraries('INVOKE_DEFAULT')")
    window.wait("not bpy.context.window.modal_operators")
    index = "__import__('sys').modules['bl_ext.user_default.unisg_blender.operators.shapes.library_index']"
    assert window.run(f"result = [asset.shape.name for asset in {index}.known_assets()]") == ["Pot"]
    window.in_viewport("bpy.ops.unisg.generate('INVOKE_DEFAULT', True, add='Plant=2', model='living_room', seed=3)")
    window.wait(f"len(bpy.context.scene.objects) == {room + 2}")
    window.wait("not bpy.context.window.modal_operators")
    shared = window.run("result = [item.data.name for item in bpy.context.selected_objects]")
    assert shared == ["Pot", "Pot"]
    window.picture("shapes-of-a-library")
    kept = window.run(f"result = str({index}._folder(False))")
    assert "asset-libraries.json" in window.run(f"import os; result = os.listdir({kept!r})")


def test_with_a_second_window_on_another_scene(window: BlenderWindow, room: int) -> None:
    window.in_viewport("bpy.ops.wm.window_new_main()")
    window.run("""
second = bpy.data.scenes.new("Second")
bpy.context.window_manager.windows[1].scene = second
""")
    try:
        begin(window, "Chair")
        window.wait(f"{SESSION}.scene == bpy.context.window_manager.windows[0].scene.name")
        window.run("""
with bpy.context.temp_override(window=bpy.context.window_manager.windows[1]):
    assert bpy.ops.unisg.add_room(kind="living-room", seed=7, with_view=False) == {"FINISHED"}
    assert bpy.ops.unisg.generate(add="Plant=1", model="living_room", seed=2) == {"FINISHED"}
""")
        assert window.run(f"result = bool({SESSION})"), "placing goes on in the other window"
        assert window.run("result = len(bpy.context.window_manager.windows[0].scene.objects)") == room
    finally:
        window.run("""
with bpy.context.temp_override(window=bpy.context.window_manager.windows[1]):
    bpy.ops.wm.window_close()
bpy.data.scenes.remove(bpy.data.scenes["Second"])
""")
    window.move(500, 420)  # the keyboard is the window's under the mouse
    window.key("Escape")
    window.wait(f"not {SESSION}")
