"""Saving the open scene as a master file and opening one, by the operators that the panel calls."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType, SimpleNamespace

import bpy
import pytest

from tests.blender.helpers import add, assert_same_scene, box
from unisg_blender.blender import read_scene
from unisg_blender.usd.pxr_library import missing_pxr

pytestmark = pytest.mark.usefixtures("extension", "fresh_file")
NEEDS_USD = pytest.mark.skipif(bool(missing_pxr()), reason="this Blender offers no USD to Python")


def moving_room() -> None:
    table = add("Table", box())
    table["unisg_category"], table["unisg_uid"] = "Table", "t"
    cup = add("Cup", box("Small", 0.1), table)
    for frame, x in ((1, 0.0), (5, 2.0)):
        cup.location.x = x
        cup.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 5
    bpy.context.scene.frame_set(1)


@NEEDS_USD
def test_saved_and_opened_again(tmp_path: Path) -> None:
    moving_room()
    before = read_scene()
    assert bpy.ops.unisg.convert(filepath=str(tmp_path / "room.usdc")) == {"FINISHED"}
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert bpy.ops.unisg.open_master_file(filepath=str(tmp_path / "room.usdc")) == {"FINISHED"}
    scene = bpy.data.scenes["Scene.001"]
    assert_same_scene(before, read_scene(scene))
    assert read_scene(scene, animation=True).components["animation"].rows.tolist() == [1]
    assert not bpy.data.scenes["Scene"].objects


@NEEDS_USD
def test_without_animation(tmp_path: Path) -> None:
    moving_room()
    bpy.ops.unisg.convert(filepath=str(tmp_path / "room.usda"), animation=False)
    assert "timeSamples" not in (tmp_path / "room.usda").read_text()


def test_json(tmp_path: Path) -> None:
    moving_room()
    bpy.ops.unisg.convert(filepath=str(tmp_path / "room.json"))
    names = sorted(item.name for item in bpy.context.scene.objects)
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.unisg.open_master_file(filepath=str(tmp_path / "room.json"))
    assert sorted(item.name for item in bpy.data.scenes[-1].objects) == names


def test_a_name_without_an_ending_gets_the_usual_one(tmp_path: Path, extension: ModuleType) -> None:
    moving_room()
    ending = ".json" if missing_pxr() else ".usdc"
    assert bpy.ops.unisg.convert(filepath=str(tmp_path / "room")) == {"FINISHED"}
    assert [path.name for path in tmp_path.iterdir()] == [f"room{ending}"]
    assert extension.operators.convert._with_ending("//") == "//"
    typed = SimpleNamespace(filepath="//a")
    check = extension.operators.convert.UNISG_OT_convert.check
    assert check(typed, bpy.context), "the file browser shows what will be written, and warns of a file of that name"
    assert typed.filepath == f"//a{ending}"
    assert not check(typed, bpy.context)
    assert "check_existing" in bpy.ops.unisg.convert.get_rna_type().properties, (
        "by this Blender knows that it is to warn"
    )


@pytest.mark.parametrize(
    ("name", "reason"), [("room.blend", "Save a Copy"), ("room.txt", "ends in"), ("no/r.json", "does not exist")]
)
def test_refused_in_one_line(tmp_path: Path, name: str, reason: str) -> None:
    moving_room()
    with pytest.raises(RuntimeError, match=reason):
        bpy.ops.unisg.convert(filepath=str(tmp_path / name))
    assert list(tmp_path.iterdir()) == []


@NEEDS_USD
def test_a_damaged_file_changes_nothing(tmp_path: Path) -> None:
    (tmp_path / "bad.usda").write_text("#usda 1.0\ndef {")
    with pytest.raises(RuntimeError, match="not a readable USD file"):
        bpy.ops.unisg.open_master_file(filepath=str(tmp_path / "bad.usda"))
    assert len(bpy.data.scenes) == 1


def test_a_scene_is_shown_after_the_file_browser_has_closed(extension: ModuleType) -> None:
    """And the bars of windows are laid out anew when that has been drawn; nothing stays registered."""
    module = extension.operators.convert
    scene = bpy.data.scenes.new("Imported")
    module._look_at(scene, SimpleNamespace(as_pointer=lambda: 1), "Import", later=True)
    assert bpy.app.timers.is_registered(module._look_then)
    bpy.app.timers.unregister(module._look_then)
    assert module._look_then() == module.DRAWN
    assert module._look_then() is None
    module._undone()
    assert bpy.app.timers.is_registered(module._look_then), "the scene before, or after, may have a longer name"
    module._look_at(scene, SimpleNamespace(as_pointer=lambda: 1), "Import", later=True)
    module.unregister()
    assert not bpy.app.timers.is_registered(module._look_then)
    module._undone()
    assert not bpy.app.timers.is_registered(module._look_then)
