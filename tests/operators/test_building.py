"""What is recognised of the building, in Blender: shown, corrected, and used for placing."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

from tests.generate.house import LEFT, RIGHT, house  # noqa: E402
from unisg_blender.blender import read_scene, write_scene  # noqa: E402
from unisg_blender.geometry.polygon import inside  # noqa: E402
from unisg_blender.scene.structure_marks import PART_MARK, ROOM_MARK  # noqa: E402


@pytest.fixture
def recognised(extension: ModuleType) -> ModuleType:
    """A house in Blender, nothing selected; the module that knows what is recognised."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    write_scene(house(), bpy.context.scene)
    bpy.ops.object.select_all(action="DESELECT")
    return sys.modules[f"{extension.__name__}.operators.room.recognised"]


def select(*names: str) -> None:
    bpy.ops.object.select_all(action="DESELECT")
    for name in names:
        bpy.data.objects[name].select_set(True)
        bpy.context.view_layer.objects.active = bpy.data.objects[name]


def kinds(recognised: ModuleType) -> list[str]:
    return sorted(name.kind for name in recognised.recognise_now(bpy.context.scene).names)


def number_of(recognised: ModuleType, kind: str) -> int:
    found = recognised.recognise_now(bpy.context.scene)
    return next(number for number, name in enumerate(found.names) if name.kind == kind)


def test_rooms_are_told(recognised: ModuleType) -> None:
    assert bpy.ops.unisg.recognise() == {"FINISHED"}
    found = recognised.recognised(bpy.context.scene)
    assert sorted(name.kind for name in found.names) == ["bedroom", "kitchen"]
    assert found.summary.startswith("2 rooms, ")
    assert any(line.endswith(": kitchen, 20.0 m2") for line in found.room_lines())


def test_the_scene_that_is_asked_for_is_looked_at_and_then_the_next(
    recognised: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each window may show another one; none is lost while one is looked at."""
    other, house = bpy.data.scenes.new("Other"), bpy.context.scene
    write_scene(read_scene(house), other)
    done = []
    monkeypatch.setattr(recognised._background, "start", lambda work, take, failed: done.append((work, take, failed)))
    recognised._known.asked.update(dict.fromkeys(("Gone", "Other", house.name)))
    recognised._begin()
    assert recognised.recognised(other) is None
    work, take, _ = done.pop()
    take(work())
    assert recognised.recognised(other) is not None
    _, _, failed = done.pop()
    failed("no room")
    assert recognised.problem(house) == "no room"
    assert not done
    recognised._forget()
    assert recognised.recognised(other) is None


def test_a_part_is_corrected_undone_and_kept(recognised: ModuleType, tmp_path: Path) -> None:
    select("wardrobe", "Spüle")
    assert bpy.ops.unisg.mark_part(part="WALL") == {"FINISHED"}
    assert {bpy.data.objects[name]["unisg_category"] for name in ("wardrobe", "Spüle")} == {"Wall"}
    assert bpy.ops.unisg.mark_part(part="THING") == {"FINISHED"}
    assert bpy.data.objects["wardrobe"][PART_MARK] == "thing"
    assert "unisg_category" not in bpy.data.objects["wardrobe"]
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "house.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "house.blend"))
    assert bpy.data.objects["wardrobe"][PART_MARK] == "thing"
    select("wardrobe")
    bpy.ops.unisg.mark_part(part="CLEAR")
    assert PART_MARK not in bpy.data.objects["wardrobe"]
    assert bpy.data.objects["Spüle"][PART_MARK] == "thing"


def test_a_floor_that_is_none_makes_no_room(recognised: ModuleType) -> None:
    select("ground")
    bpy.ops.unisg.mark_part(part="NOTHING")
    assert kinds(recognised) == []
    assert recognised.recognised(bpy.context.scene).summary.startswith("no floor was found")
    with pytest.raises(RuntimeError, match="no floor was found"):
        bpy.ops.unisg.mark_room(kind="kitchen", number=0)


def test_a_room_is_said_to_be_another_and_none(recognised: ModuleType) -> None:
    kitchen = number_of(recognised, "kitchen")
    count = len(bpy.data.objects)
    assert bpy.ops.unisg.mark_room(kind="Office", number=kitchen) == {"FINISHED"}
    assert kinds(recognised) == ["bedroom", "office"]
    (marker,) = [item for item in bpy.data.objects if ROOM_MARK in item]
    assert (marker.name, marker.type, marker[ROOM_MARK]) == ("Office", "EMPTY", "Office")
    assert inside(LEFT, np.array(marker.location[:2]))
    bpy.ops.unisg.mark_room(kind="garage", number=number_of(recognised, "office"))
    assert len([item for item in bpy.data.objects if ROOM_MARK in item]) == 1
    assert kinds(recognised) == ["bedroom", "garage"]
    bpy.ops.unisg.mark_room(kind="", number=number_of(recognised, "garage"))
    assert len(bpy.data.objects) == count
    assert kinds(recognised) == ["bedroom", "kitchen"]
    select("Doppelbett")
    bpy.ops.unisg.mark_room(kind="none")
    assert kinds(recognised) == ["kitchen"]
    with pytest.raises(RuntimeError, match="Doppelbett is in no room"):
        bpy.ops.unisg.mark_room(kind="bedroom")
    with pytest.raises(RuntimeError, match="there is no room 7: 1 are recognised"):
        bpy.ops.unisg.mark_room(kind="bedroom", number=7)


def test_a_mark_on_something_else_is_taken_from_it_and_that_stays(recognised: ModuleType) -> None:
    bpy.data.objects["Fridge.001"][ROOM_MARK] = "garage"
    number = number_of(recognised, "garage")
    bpy.ops.unisg.mark_room(kind="office", number=number)
    assert bpy.data.objects["Fridge.001"][ROOM_MARK] == "office"
    bpy.ops.unisg.mark_room(kind="", number=number)
    assert ROOM_MARK not in bpy.data.objects["Fridge.001"]


def test_an_empty_is_in_the_scenes_units(recognised: ModuleType) -> None:
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    bpy.context.scene.unit_settings.scale_length = 0.01
    write_scene(house(), bpy.context.scene)
    bpy.ops.unisg.mark_room(kind="office", number=number_of(recognised, "kitchen"))
    (marker,) = [item for item in bpy.data.objects if ROOM_MARK in item]
    assert inside(LEFT * 100, np.array(marker.location[:2]))
    assert kinds(recognised) == ["bedroom", "office"]
    shapes = recognised.recognised(bpy.context.scene).shapes
    assert np.ptp(np.concatenate(list(shapes.lines.values()))[:, 0]) == pytest.approx(1010, abs=10)


def test_things_are_generated_in_a_room(recognised: ModuleType) -> None:
    known = set(bpy.data.objects)
    words = {"model": "living_room", "add": "Chair=2", "seed": 3, "behaviour": False}
    assert bpy.ops.unisg.generate(within="the bedroom", **words) == {"FINISHED"}
    new = [item for item in bpy.data.objects if item not in known and item.parent not in set(bpy.data.objects) - known]
    assert len(new) >= 2
    assert all(inside(RIGHT, np.array(item.matrix_world.translation[:2])) for item in new)
    with pytest.raises(RuntimeError, match="no room of the scene is 'bathroom'"):
        bpy.ops.unisg.generate(within="bathroom", **words)


def test_rooms_to_choose_are_what_each_is_or_its_number(recognised: ModuleType, extension: ModuleType) -> None:
    choose = sys.modules[f"{extension.__name__}.operators.room.corrections"].rooms_to_choose
    bpy.data.objects["Doppelbett"][ROOM_MARK] = "kitchen"
    recognised.recognise_now(bpy.context.scene)
    assert [name for name, _ in choose(None, bpy.context, "")] == ["0", "1"]
    del bpy.data.objects["Doppelbett"][ROOM_MARK]
    recognised.recognise_now(bpy.context.scene)
    assert sorted(name for name, _ in choose(None, bpy.context, "")) == ["bedroom", "kitchen"]
    assert [name for name, _ in choose(None, bpy.context, "kit")] == ["kitchen"]


def test_what_is_drawn_covers_the_rooms(recognised: ModuleType, extension: ModuleType) -> None:
    shapes = recognised.recognise_now(bpy.context.scene).shapes
    module = sys.modules[f"{extension.__name__}.operators.room.structure_shapes"]
    first, second, third = shapes.triangles[module.ROOM].reshape(-1, 3, 3).transpose(1, 0, 2)
    assert np.linalg.norm(np.cross(second - first, third - first), axis=1).sum() / 2 == pytest.approx(40, rel=0.02)
    assert sorted(text for text, _ in shapes.labels) == ["bedroom, 20.0 m2", "kitchen, 20.0 m2"]
    for _, place in shapes.labels:
        assert inside(LEFT, np.array(place[:2])) or inside(RIGHT, np.array(place[:2]))
    assert module.OPENINGS["door"] in shapes.lines
    assert all(len(points) % 2 == 0 for points in shapes.lines.values())


def test_collections_tell_rooms_without_other_details(recognised: ModuleType) -> None:
    office = bpy.data.collections.new("Office")
    bpy.context.scene.collection.children.link(office)
    for name in ("Fridge.001", "SM_Stove_01", "Spüle"):
        office.objects.link(bpy.data.objects[name])
    assert kinds(recognised) == ["bedroom", "office"]
    assert read_scene(bpy.context.scene, details=False).components["collections"]


def test_rooms_are_offered_by_every_word_that_tells_them_apart(recognised: ModuleType) -> None:
    module = sys.modules[recognised.__name__.replace("recognised", "corrections")]
    name = sys.modules[
        recognised.__name__.split(".operators")[0] + ".unisg_blender.spatial.structure.room_things"
    ].RoomName
    names = [name("living room"), name("living room", "", ("kitchen",)), name("bedroom", "", ("office",)), name()]
    assert module._told_apart(names) == [["0"], ["kitchen"], ["bedroom", "office"], ["3"]]
    names = [name("living room", "", ("kitchen",)), name("kitchen")]
    assert module._told_apart(names) == [["living room"], ["kitchen"]]
