"""Placing one thing: by script, and by pointing as far as that goes without a window."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

SEED = 5
"""Of the fixture ``room``."""

OPTIONS = {"model": "living_room", "seed": 1}


def things(category: str) -> list[bpy.types.Object]:
    return [item for item in bpy.context.scene.objects if item.get("unisg_category") == category]


def placed(category: str, **how: object) -> bpy.types.Object:
    """Place one, and the new object."""
    before = {item.name for item in bpy.data.objects}
    assert bpy.ops.unisg.place(category=category, **{**OPTIONS, **how}) == {"FINISHED"}
    bpy.context.view_layer.update()
    (new,) = [item for item in things(bpy.context.active_object["unisg_category"]) if item.name not in before]
    assert bpy.context.active_object == new
    return new


def foot(item: bpy.types.Object) -> np.ndarray:
    """The middle of the bottom of an object with its parts."""
    parts = [part for part in (item, *item.children_recursive) if part.type == "MESH"]
    corners = np.array([part.matrix_world @ vertex.co for part in parts for vertex in part.data.vertices])
    low, high = corners.min(axis=0), corners.max(axis=0)
    return np.array([*(low + high)[:2] / 2, low[2]])


def test_a_cup_goes_to_the_best_place_near_a_point(room: None) -> None:
    table = things("Coffee Table")[0]
    near = np.add(table.matrix_world.translation, (0.2, 0.1, 0.42))
    before = {item.name: item.matrix_world.copy() for item in bpy.data.objects}
    cup = placed("cup", location=near)
    assert cup.parent == table
    assert np.linalg.norm(foot(cup) - near) < 1.0
    assert all(bpy.data.objects[name].matrix_world == world for name, world in before.items())


def test_exactly_there_is_exactly_there_and_what_is_wrong_is_told(room: None) -> None:
    sofa = things("Sofa")[0].matrix_world.translation
    chair = placed("Chair", how="EXACT", location=(sofa.x, sofa.y, 0.0), turn=0.3)
    np.testing.assert_allclose(foot(chair), (sofa.x, sofa.y, 0.0), atol=1e-4)
    assert chair.matrix_world.to_euler().z % (2 * np.pi) == pytest.approx(0.3, abs=1e-4)


def test_anywhere_is_by_the_seed(room: None) -> None:
    first = foot(placed("Chair", how="ANYWHERE", seed=3))
    bpy.ops.object.delete()
    second = foot(placed("Chair", how="ANYWHERE", seed=3))
    np.testing.assert_allclose(first, second, atol=1e-6)


def test_another_one_of_an_object_shares_its_mesh_and_is_locked_if_wished(room: None) -> None:
    sofa = things("Sofa")[0]
    again = placed("", source=sofa.name, how="ANYWHERE", lock=True)
    meshes = {part.data for part in (sofa, *sofa.children_recursive) if part.type == "MESH"}
    assert {part.data for part in (again, *again.children_recursive) if part.type == "MESH"} == meshes
    assert again["unisg_lock"] == "yes"
    assert again["unisg_uid"] != sofa.get("unisg_uid")


def test_on_and_beside_something(room: None) -> None:
    table = things("Dining Table")[0]
    assert placed("Vase", on=table.name, location=table.matrix_world.translation).parent == table


def test_it_is_one_step_of_undo(room: None) -> None:
    count = len(bpy.data.objects)
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.unisg.place("EXEC_DEFAULT", True, category="Chair", how="ANYWHERE", **OPTIONS) == {"FINISHED"}
    assert len(bpy.data.objects) > count
    bpy.ops.ed.undo()
    assert len(bpy.data.objects) == count


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"category": "Qwertz"}, "does not know 'Qwertz'"),
        ({"source": "Nobody"}, "is not in the scene"),
        ({"category": "Chair", "on": "Nobody"}, "Nobody"),
        ({}, "category"),
    ],
)
def test_what_cannot_be_placed_is_said_and_nothing_is_changed(room: None, how: dict[str, str], said: str) -> None:
    count = len(bpy.data.objects)
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.unisg.place(**{**OPTIONS, **how})
    assert len(bpy.data.objects) == count


def test_in_other_units_it_stands_where_it_is_said(room: None) -> None:
    scene = bpy.context.scene
    scene.unit_settings.system, scene.unit_settings.scale_length = "METRIC", 0.01
    scene.unit_settings.length_unit = "CENTIMETERS"
    for item in bpy.data.objects:
        if item.parent is None:
            item.matrix_world = [[100 * value for value in row[:4]] for row in item.matrix_world[:3]] + [[0, 0, 0, 1]]
    bpy.context.view_layer.update()
    chair = placed("Chair", how="EXACT", location=(30.0, 20.0, 0.0))
    np.testing.assert_allclose(foot(chair), (30.0, 20.0, 0.0), atol=0.1)


def session(extension: ModuleType, category: str = "Chair") -> object:
    """Placing in the open scene, what is known of the room looked up at once."""
    module = extension.operators.placing.placing_session
    path = extension.operators.making.generation_settings.shipped_models()
    model = next(str(each) for each in path if each.stem == "living_room")
    current = module.Placing(bpy.context.scene, module.PlacingChoice(model, category), True)
    module.begin_placing(current)

    def at_once(work: object, done: object, failed: object) -> None:
        done(work())

    current._looking = SimpleNamespace(start=at_once, busy=False, end=lambda: None)
    current.look(anew=True)
    return current


def test_the_ghost_follows_the_mouse_and_the_words_say_what_is_wrong(extension: ModuleType, room: None) -> None:
    module = extension.operators.placing
    current = session(extension)
    sofa = things("Sofa")[0].matrix_world.translation
    current.point_at(module.pointed_at.Pointed((0.3, 0.4, 0.0), True))
    first = tuple(current.ghost.place)
    assert current.lines()[0] == "Chair: fits"
    current.next_place(1)
    assert tuple(current.ghost.place) != first
    current.point_at(module.pointed_at.Pointed((sofa.x, sofa.y, 0.0), True))
    current.turn_by(0.2)
    np.testing.assert_allclose(current.ghost.place[:2], (sofa.x, sofa.y), atol=1e-6)
    turned = current.yaw
    current.point_at(module.pointed_at.Pointed((sofa.x + 0.1, sofa.y, 0.0), True))
    assert current.ghost.place[3] == turned
    assert current.lines()[0].startswith("Chair: collides with ")
    current.locked = True
    assert "locked" in current.lines()
    current.draw_anew()
    assert current.drawn
    module.placing_session.end_placing()
    assert module.placing_session.placing() is None


def test_esc_ends_it_and_other_keys_are_blenders(extension: ModuleType, room: None) -> None:
    module = extension.operators.placing
    operator = module.place.UNISG_OT_place
    current = session(extension)
    context = SimpleNamespace(
        scene=bpy.context.scene, mode="OBJECT", window=SimpleNamespace(screen=SimpleNamespace(areas=[])),
        workspace=MagicMock(), window_manager=bpy.context.window_manager,
    )  # fmt: skip

    def event(kind: str, **more: object) -> SimpleNamespace:
        given = {
            "value": "PRESS",
            "shift": False,
            "ctrl": False,
            "alt": False,
            "oskey": False,
            "mouse_x": 0,
            "mouse_y": 0,
        }
        return SimpleNamespace(type=kind, **{**given, **more})

    self = MagicMock(spec=operator)
    for name in ("_leave", "_is_blenders"):
        setattr(self, name, getattr(operator, name).__get__(self))
    self._own = current
    for kind in ("MIDDLEMOUSE", "NUMPAD_1", "N"):
        assert operator.modal(self, context, event(kind)) == {"PASS_THROUGH"}
    assert operator.modal(self, context, event("Z", ctrl=True)) == {"PASS_THROUGH"}
    assert module.placing_session.placing() is current
    before = MagicMock(spec=operator, _own=None)
    assert operator.modal(before, context, event("LEFTMOUSE")) == {"CANCELLED"}, "the one before lets go"
    assert module.placing_session.placing() is current
    assert operator.modal(self, context, event("ESC")) == {"CANCELLED"}
    assert module.placing_session.placing() is None


def test_what_was_to_be_measured_soon_is_left(extension: ModuleType, room: None) -> None:
    current = session(extension)
    bpy.app.timers.register(current._still, first_interval=100)
    current.end()
    assert not bpy.app.timers.is_registered(current._still)
    extension.operators.placing.placing_session.end_placing()


def test_another_file_and_switching_off_leave_nothing(extension: ModuleType, room: None, saved: Path) -> None:
    module = extension.operators.placing.placing_session
    session(extension)
    bpy.ops.wm.open_mainfile(filepath=str(saved))
    assert module.placing() is None
    session(extension)
    extension.operators.placing.place.unregister()
    assert module.placing() is None


def test_the_list_has_what_the_model_knows_and_the_active_object(extension: ModuleType, room: None) -> None:
    extension.operators.making.generation_settings.choose_model(bpy.context, "living_room")
    bpy.context.view_layer.objects.active = things("Sofa")[0]
    found = extension.operators.placing.choose_and_place._choices(None, bpy.context)
    assert found[0][0] == f"OBJECT:{things('Sofa')[0].name}"
    assert {"Chair", "Cup"} <= {name for name, *_ in found}


def test_the_heat_is_blue_to_yellow_and_stronger(extension: ModuleType) -> None:
    colours = extension.panels.placing_overlay.heat_colours(np.linspace(0, 1, 5))
    assert colours.shape == (5, 4)
    assert (np.diff(colours[:, 3]) > 0).all()
    light = colours[:, :3] @ (0.2126, 0.7152, 0.0722)
    assert (np.diff(light) > 0).all()


def test_of_a_collection_an_instance_is_placed(room: None) -> None:
    bpy.ops.mesh.primitive_cube_add(size=0.4, location=(20.0, 0.0, 0.2))
    cube = bpy.context.object
    collection = bpy.data.collections.new("Stool")
    collection.instance_offset = (20.0, 0.0, 0.0)
    for each in cube.users_collection:
        each.objects.unlink(cube)
    collection.objects.link(cube)
    count = len(bpy.data.objects)
    new = placed("Side Table", collection="Stool", how="EXACT", location=(0.5, 0.4, 0.0))
    assert (new.instance_type, new.instance_collection) == ("COLLECTION", collection)
    assert len(bpy.data.objects) == count + 1
    np.testing.assert_allclose(new.matrix_world.translation, (0.5, 0.4, 0.0), atol=1e-5)
    near = placed("Side Table", collection="Stool", location=(0.5, 0.4, 0.0))
    assert (near.matrix_world.translation - new.matrix_world.translation).length > 0.3, "the first one is in the way"
    with pytest.raises(RuntimeError, match="is no collection"):
        bpy.ops.unisg.place(collection="Nothing", **OPTIONS)
