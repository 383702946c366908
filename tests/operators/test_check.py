"""Checking the scene from Blender: the list, going to what is wrong, settling from there."""

from __future__ import annotations

from types import ModuleType

import pytest

bpy = pytest.importorskip("bpy")

from tests.generate.house import KITCHEN  # noqa: E402
from tests.spatial.built_rooms import SQUARE, box, room, scene  # noqa: E402
from unisg_blender.blender import write_scene  # noqa: E402


@pytest.fixture
def listed(extension: ModuleType):
    """A kitchen with a crate in the air and one in the fridge, in Blender; the list of the check."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    crates = {"High": box((2, 1, 0.2), (2.5, 1.5, 0.6)), "Deep": box((0.2, 2.7, 0), (0.7, 3.23, 0.5))}
    write_scene(scene(room(SQUARE, 0.1) | KITCHEN | crates), bpy.context.scene)
    return bpy.context.window_manager.unisg_check


def texts(listed) -> dict[str, str]:
    return {item.name: item.text for item in listed.faults}


def test_what_is_wrong_is_listed_selected_and_settled(listed) -> None:
    assert bpy.ops.unisg.check() == {"FINISHED"}
    assert texts(listed) == {"High": "floats by 20 cm", "Deep": "collides with Fridge.001 by 3 cm"}
    assert listed.summary == "5 things: 3 fine, 1 in collision, 1 floating"
    (high,) = [item for item in listed.faults if item.name == "High"]
    assert bpy.ops.unisg.show_object(uid=high.uid) == {"FINISHED"}
    assert [item.name for item in bpy.context.selected_objects] == ["High"]
    assert bpy.context.active_object.name == "High"
    assert bpy.ops.unisg.select_faults() == {"FINISHED"}
    assert {item.name for item in bpy.context.selected_objects} == {"High", "Deep"}
    bpy.ops.unisg.settle()
    bpy.ops.unisg.check()
    assert texts(listed) == {}
    assert listed.summary == "5 things: 5 fine"
    assert not bpy.ops.unisg.select_faults.poll()


def test_what_is_gone_is_told(listed) -> None:
    bpy.ops.unisg.check()
    bpy.data.objects.remove(bpy.data.objects["High"])
    (high,) = [item for item in listed.faults if item.name == "High"]
    with pytest.raises(RuntimeError, match="no longer there"):
        bpy.ops.unisg.show_object(uid=high.uid)


def test_another_file_empties_the_list(listed) -> None:
    bpy.ops.unisg.check()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert not len(bpy.context.window_manager.unisg_check.faults)
    assert not bpy.ops.unisg.check.poll()
