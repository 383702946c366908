"""Generating from Blender: the operator as a script calls it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

from unisg_blender.blender import read_scene, write_scene  # noqa: E402
from unisg_blender.scene import world_matrices  # noqa: E402
from unisg_blender.worlds import operating_room  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.usefixtures("extension")


@pytest.fixture
def room():
    """An operating room in Blender; its names, uids and world matrices."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    write_scene(operating_room(5), bpy.context.scene)
    return snapshot()


def snapshot() -> dict[str, np.ndarray]:
    """World matrix of every object by uid."""
    graph = read_scene(bpy.context.scene, geometry="none")
    return dict(zip(graph.uid, world_matrices(graph), strict=True))


def test_adds_what_was_asked_and_moves_nothing(room: dict[str, np.ndarray]) -> None:
    assert bpy.ops.unisg.generate(add="Scalpel=2,Monitor=1", seed=4) == {"FINISHED"}
    after = snapshot()
    assert len(after) == len(room) + 3
    for uid, world in room.items():
        np.testing.assert_array_equal(after[uid], world)
    added = [item for item in bpy.context.scene.objects if item["unisg_uid"] not in room]
    assert sorted(item["unisg_category"] for item in added) == ["Monitor", "Scalpel", "Scalpel"]
    assert set(bpy.context.selected_objects) == set(added)
    assert all(item.data is not None and len(item.data.vertices) for item in added)


def test_same_seed_same_places(room: dict[str, np.ndarray]) -> None:
    bpy.ops.unisg.generate(add="Stool=2", seed=9)
    first = snapshot()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    write_scene(operating_room(5), bpy.context.scene)
    bpy.ops.unisg.generate(add="Stool=2", seed=9)
    second = snapshot()
    assert first.keys() == second.keys()
    for uid, world in first.items():
        np.testing.assert_array_equal(second[uid], world)


def test_objects_come_on_and_beside_what_is_named(room: dict[str, np.ndarray]) -> None:
    table = next(item for item in bpy.context.scene.objects if item.get("unisg_category") == "Instrument Table")
    assert bpy.ops.unisg.generate(add="Bowl=1", seed=4, on=table.name) == {"FINISHED"}
    cloth = bpy.context.active_object.parent  # the drape covers the table
    assert (cloth["unisg_category"], cloth.parent) == ("Drape", table)
    bin_ = next(item for item in bpy.context.scene.objects if item.get("unisg_category") == "Waste Bin")
    assert bpy.ops.unisg.generate(add="Stool=1", seed=4, beside=bin_.name) == {"FINISHED"}
    new = bpy.context.active_object
    assert new["unisg_category"] == "Stool"
    assert (new.matrix_world.translation - bin_.matrix_world.translation).length < 1.5
    with pytest.raises(RuntimeError, match="nothing in the scene is called 'Sofa'"):
        bpy.ops.unisg.generate(add="Stool=1", beside="Sofa")


def test_what_they_are_wanted_on_stays_active_for_the_next_ones(room: dict[str, np.ndarray]) -> None:
    table = next(item for item in bpy.context.scene.objects if item.get("unisg_category") == "Instrument Table")
    bpy.context.view_layer.objects.active = table
    assert bpy.ops.unisg.generate(add="Bowl=1", seed=4, on=table.name) == {"FINISHED"}
    assert bpy.context.active_object == table
    assert [item["unisg_category"] for item in bpy.context.selected_objects] == ["Bowl"]


def test_an_object_that_is_no_place_is_told_as_such(room: dict[str, np.ndarray]) -> None:
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    with pytest.raises(RuntimeError, match="'Camera' has neither a mesh nor a category"):
        bpy.ops.unisg.generate(add="Stool=1", beside="Camera")
    table = next(item for item in bpy.context.scene.objects if item.get("unisg_category") == "Instrument Table")
    handle = bpy.data.objects.new("Handle", bpy.data.meshes.new("Handle"))
    bpy.context.scene.collection.objects.link(handle)
    handle.parent = table
    with pytest.raises(RuntimeError, match=f"'Handle' is a part of '{table.name}'"):
        bpy.ops.unisg.generate(add="Stool=1", beside="Handle")


def test_settles_the_selected_objects_and_nothing_else(room: dict[str, np.ndarray]) -> None:
    stool = next(item for item in bpy.context.scene.objects if item.get("unisg_category") == "Stool")
    uid, stands = stool["unisg_uid"], stool.matrix_world.copy()
    stool.matrix_world.translation.z += 0.8
    bpy.context.view_layer.update()
    bpy.ops.object.select_all(action="DESELECT")
    assert not bpy.ops.unisg.settle.poll()
    stool.select_set(True)
    assert bpy.ops.unisg.settle() == {"FINISHED"}
    after = snapshot()
    np.testing.assert_allclose(after[uid], np.array(stands), atol=2e-3)
    for other, world in room.items():
        if other != uid:
            np.testing.assert_array_equal(after[other], world)


def test_a_shipped_model_is_known_by_its_name(room: dict[str, np.ndarray]) -> None:
    assert bpy.ops.unisg.generate(model="operating_room", add="Stool=1", seed=4) == {"FINISHED"}
    assert len(snapshot()) == len(room) + 1


def test_starts_a_room_from_nothing() -> None:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert bpy.ops.unisg.generate(add="Floor=1,Wall=4,Operating Table=1", seed=1) == {"FINISHED"}
    categories = [item.get("unisg_category") for item in bpy.context.scene.objects]
    assert categories.count("Floor") == 1
    assert categories.count("Operating Table") == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"add": "Scalpell=1"}, "Scalpel"),
        ({"add": "Scalpel=two"}, "Scalpel=2"),
        ({"add": ""}, "must look like|nothing to add|categories"),
        ({"add": "Scalpel=1", "model": "/nowhere/model.onnx"}, "there is no model"),
        ({"add": "Scalpel=1", "model": str(ROOT / "README.md")}, "no ONNX model"),
    ],
)
def test_bad_requests_are_told_and_change_nothing(
    room: dict[str, np.ndarray], arguments: dict[str, str], message: str
) -> None:
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.unisg.generate(**arguments)
    assert snapshot().keys() == room.keys()


def test_the_list_has_the_models_categories_and_keeps_counts(room: dict[str, np.ndarray]) -> None:
    settings = bpy.context.window_manager.unisg
    listing = sys.modules["unisg_extension.operators.making.generation_settings"].list_categories
    listing(settings)
    assert settings.problem == ""
    assert {"Scalpel", "Monitor", "IV Pole"} <= {item.name for item in settings.counts}
    settings.counts["Scalpel"].count = 3
    listing(settings)
    assert settings.wanted() == {"Scalpel": 3}


def test_a_file_that_is_no_model_is_told_in_the_panel() -> None:
    settings = bpy.context.window_manager.unisg
    settings.model, settings.path = "FILE", str(ROOT / "README.md")
    sys.modules["unisg_extension.operators.making.generation_settings"].list_categories(settings)
    assert "no ONNX model" in settings.problem
    assert len(settings.counts) == 0


def test_a_room_in_centimetres_gets_what_one_in_metres_gets() -> None:
    places, sizes = [], []
    for metres in (1.0, 0.01):
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        bpy.context.scene.unit_settings.scale_length = metres
        write_scene(operating_room(5), bpy.context.scene)
        there = set(bpy.context.scene.objects)
        bpy.ops.unisg.generate(add="Scalpel=2,Monitor=1,Stool=1", seed=4)
        bpy.context.view_layer.update()
        added = sorted(set(bpy.context.scene.objects) - there, key=lambda item: item.name)
        places.append([np.array(item.matrix_world.translation) * metres for item in added])
        sizes.append([np.array(item.dimensions) * metres for item in added])
    assert len(places[0]) == 4
    np.testing.assert_allclose(places[1], places[0], atol=1e-4)
    np.testing.assert_allclose(sizes[1], sizes[0], atol=1e-5)


def test_settling_in_centimetres() -> None:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.context.scene.unit_settings.scale_length = 0.01
    write_scene(operating_room(5), bpy.context.scene)
    bpy.context.view_layer.update()
    stool = next(item for item in bpy.context.scene.objects if item.get("unisg_category") == "Stool")
    before = np.array(stool.matrix_world)
    stool.location.z += 30
    bpy.context.view_layer.update()
    stool.select_set(True)
    assert bpy.ops.unisg.settle() == {"FINISHED"}
    np.testing.assert_allclose(stool.matrix_world, before, atol=0.5)  # centimetres


def reports(capfd: pytest.CaptureFixture[str]) -> str:
    return capfd.readouterr().out


def test_new_objects_are_in_the_collection_of_their_room(capfd: pytest.CaptureFixture[str]) -> None:
    """And nothing is said of a lesson that nobody has."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    settings = bpy.context.window_manager.unisg
    settings.property_unset("model")  # a model of one's own would stay
    bpy.ops.unisg.add_room(kind="living-room", seed=1)
    assert Path(settings.model).stem == "living_room"
    for item in [item for item in bpy.data.objects if "unisg_lsa" in item]:
        bpy.data.objects.remove(item)
    capfd.readouterr()
    bpy.ops.unisg.generate(model=settings.model, add="Chair=2", seed=3)
    assert "lesson" not in reports(capfd)
    (room,) = [each for each in bpy.data.collections if each.name.startswith("Living Room")]
    assert all(room in item.users_collection for item in bpy.context.selected_objects)
    assert not any(item.type == "MESH" for item in bpy.context.scene.collection.objects)
