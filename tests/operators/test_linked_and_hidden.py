"""Making things among linked and overridden objects, in hidden and excluded collections, and with two scenes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

pytestmark = pytest.mark.slow

SEED = 5
"""Of the fixture ``room``."""

MODEL = {"model": "living_room", "seed": 2}


def things(category: str) -> list[bpy.types.Object]:
    return [item for item in bpy.context.scene.objects if item.get("unisg_category") == category]


def snapshot() -> dict[tuple[str, str], np.ndarray]:
    """Where everything is."""
    bpy.context.view_layer.update()
    return {
        (item.name, item.library.filepath if item.library else ""): np.array(item.matrix_world)
        for item in bpy.data.objects
    }


def made(work: Callable[[], set[str]]) -> list[bpy.types.Object]:
    """What some work adds to the scene; everything else stays where it was."""
    before = snapshot()
    assert work() == {"FINISHED"}
    after = snapshot()
    for key, world in before.items():
        np.testing.assert_allclose(after[key], world, atol=1e-6, err_msg=str(key))
    return [item for item in bpy.context.scene.objects if (item.name, "") not in before and item.library is None]


def generate(add: str, **how: object) -> set[str]:
    return bpy.ops.unisg.generate(add=add, **{**MODEL, **how})


def place(category: str, **how: object) -> set[str]:
    return bpy.ops.unisg.place(category=category, **{**MODEL, "how": "ANYWHERE", **how})


@pytest.fixture
def linked(saved: Path) -> str:
    """An empty scene into which the whole room is linked; the collection's name."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(saved), link=True) as (there, wanted):
        wanted.collections = ["Living Room"] if "Living Room" in there.collections else list(there.collections)[:1]
    (collection,) = wanted.collections
    bpy.context.scene.collection.children.link(collection)
    bpy.context.view_layer.update()
    return collection.name


@pytest.fixture
def overridden(linked: str) -> None:
    """The same room as an override of this file, all of it editable."""
    collection = bpy.data.collections[linked]
    made = collection.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer, do_fully_editable=True)
    assert made is not None
    if linked in bpy.context.scene.collection.children:
        for child in list(bpy.context.scene.collection.children):
            if child.library is not None:
                bpy.context.scene.collection.children.unlink(child)
    bpy.context.view_layer.update()


def test_in_a_linked_room_things_are_made_and_stand_on_what_is_linked(linked: str) -> None:
    with pytest.raises(RuntimeError, match="make a library override"):
        generate("Cup=1")  # its lesson cannot be extended
    new = made(lambda: generate("Plant=1,Cup=1", behaviour=False))
    assert sorted(item["unisg_category"] for item in new) == ["Cup", "Plant"]
    cup = next(item for item in new if item["unisg_category"] == "Cup")
    assert cup.parent.library is not None
    (book,) = made(lambda: place("Book", behaviour=False))
    assert book["unisg_category"] == "Book"


def test_what_is_linked_is_not_moved_and_it_is_said(linked: str) -> None:
    before, chair = snapshot(), things("Chair")[0]
    chair.select_set(True)
    for work in (bpy.ops.unisg.settle, bpy.ops.unisg.reroll):
        with pytest.raises(RuntimeError, match="linked from another file: make a library override first"):
            work()
    for key, world in snapshot().items():
        np.testing.assert_allclose(before[key], world, atol=1e-6)


def test_overridden_things_are_rerolled_and_settled_and_locked(overridden: None) -> None:
    (plant, *_) = (item for item in things("Plant") if item.override_library)
    start = np.array(plant.matrix_world)
    bpy.ops.object.select_all(action="DESELECT")
    plant.select_set(True)
    assert bpy.ops.unisg.reroll(**MODEL) == {"FINISHED"}
    bpy.context.view_layer.update()
    assert not np.allclose(start, plant.matrix_world, atol=1e-3)
    plant.matrix_world.translation.z += 0.4
    bpy.context.view_layer.update()
    assert bpy.ops.unisg.settle() == {"FINISHED"}
    assert bpy.ops.unisg.lock(how="LOCK") == {"FINISHED"}
    new = made(lambda: generate("Cup=1", behaviour=False))
    assert len(new) == 1


def layer(name: str) -> bpy.types.LayerCollection:
    return next(each for each in bpy.context.view_layer.layer_collection.children if each.name == name)


def test_what_is_hidden_is_in_the_way_as_before_and_new_things_are_seen(room: None) -> None:
    for item in things("Chair") + things("Sofa"):
        item.hide_set(True)
    things("Coffee Table")[0].hide_viewport = True
    new = made(lambda: generate("Plant=2")) + made(lambda: place("Chair"))
    assert len(new) == 3
    assert all(item.visible_get() for item in new)


@pytest.mark.parametrize("how", ["exclude", "hide_viewport"])
def test_with_the_whole_room_switched_off(room: None, how: str) -> None:
    home = next(child for child in bpy.context.scene.collection.children if child.all_objects)
    setattr(layer(home.name), how, True)
    bpy.context.view_layer.update()
    count = len(bpy.context.scene.objects)
    assert generate("Plant=1") == {"FINISHED"}
    assert place("Plant") == {"FINISHED"}
    assert len(bpy.context.scene.objects) >= count + 2
    setattr(layer(home.name), how, False)
    bpy.context.view_layer.update()
    worlds = [np.array(item.matrix_world) for item in things("Plant")]
    assert all(np.isfinite(world).all() for world in worlds)
    assert max(abs(world[:2, 3]).max() for world in worlds) < 6, "in the room"


def test_into_an_active_collection_that_is_excluded(
    extension: object, room: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(extension.operators.preferences.DEFAULTS, "home", "ACTIVE")
    away = bpy.data.collections.new("Away")
    bpy.context.scene.collection.children.link(away)
    bpy.context.view_layer.active_layer_collection = layer("Away")
    layer("Away").exclude = True
    (plant,) = made(lambda: generate("Plant=1"))
    assert plant.name in bpy.context.view_layer.objects, "one sees what was made"


def test_of_two_scenes_the_other_one_stays(room: None) -> None:
    first, second = bpy.context.scene, bpy.data.scenes.new("Second")
    shared = things("Sofa")[0]
    second.collection.objects.link(shared)
    bpy.context.window.scene = second
    assert bpy.ops.unisg.add_room(kind="living-room", seed=7, with_view=False) == {"FINISHED"}
    names = {item.name for item in first.objects}
    new = made(lambda: generate("Plant=1")) + made(lambda: place("Cup"))
    assert len(new) == 2
    assert {item.name for item in first.objects} == names
    assert not [item for item in new if item.name in first.objects]
    bpy.context.window.scene = first
    assert len(made(lambda: generate("Plant=1"))) == 1
    assert not [item for item in second.objects if item.name in first.objects and item != shared]


def test_undo_and_redo_fifty_times_of_all_that_makes_and_moves(room: None) -> None:
    bpy.ops.ed.undo_push(message="before")
    count = len(bpy.data.objects)
    steps = (
        lambda: bpy.ops.unisg.generate("EXEC_DEFAULT", True, add="Plant=1", **MODEL),
        lambda: bpy.ops.unisg.place("EXEC_DEFAULT", True, category="Chair", how="ANYWHERE", **MODEL),
        lambda: bpy.ops.unisg.lock("EXEC_DEFAULT", True, how="LOCK"),
        lambda: bpy.ops.unisg.lock("EXEC_DEFAULT", True, how="FREE"),
        lambda: bpy.ops.unisg.reroll("EXEC_DEFAULT", True, **MODEL),
        lambda: bpy.ops.unisg.choose_shape("EXEC_DEFAULT", True, category="Cup"),
    )
    for step in steps:
        assert step() == {"FINISHED"}
    done = snapshot()
    for _ in range(50):
        for _ in steps:
            bpy.ops.ed.undo()
        assert len(bpy.data.objects) == count
        for _ in steps:
            bpy.ops.ed.redo()
    after = snapshot()
    assert after.keys() == done.keys()
    for key, world in done.items():
        np.testing.assert_allclose(after[key], world, atol=1e-6)
    assert "Cup" in bpy.context.scene.unisg_shapes
