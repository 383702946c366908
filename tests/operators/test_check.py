"""Checking the scene from Blender: the list, going to what is wrong, settling from there."""

from __future__ import annotations

import sys
from types import ModuleType, SimpleNamespace

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
    listed.active = [item.name for item in listed.faults].index("High")
    assert [item.name for item in bpy.context.selected_objects] == ["High"]
    assert bpy.context.active_object.name == "High"
    assert bpy.ops.unisg.select_faults() == {"FINISHED"}
    assert {item.name for item in bpy.context.selected_objects} == {"High", "Deep"}
    bpy.ops.unisg.settle()
    assert not len(listed.faults), "without a window what is old is gone; in one it is looked at anew"
    bpy.ops.unisg.check()
    assert texts(listed) == {}
    assert listed.summary == "5 things: 5 fine"
    assert not bpy.ops.unisg.select_faults.poll()


def test_a_click_shows_what_is_around_a_thing(extension: ModuleType, listed) -> None:
    view = SimpleNamespace(view_perspective="CAMERA", view_location=None, view_distance=0.0)
    module = sys.modules[f"{extension.__name__}.operators.room.checking"]
    bpy.context.view_layer.update()
    module._look_at(view, [bpy.data.objects["High"]], 1.0)
    assert view.view_perspective == "PERSP"
    assert tuple(view.view_location) == pytest.approx((2.25, 1.25, 0.4), abs=1e-5)
    assert view.view_distance > 3


def test_what_is_gone_is_told(listed) -> None:
    bpy.ops.unisg.check()
    bpy.data.objects.remove(bpy.data.objects["High"])
    listed.active = [item.name for item in listed.faults].index("High")
    assert listed.old
    assert not bpy.context.selected_objects


def test_what_moves_nothing_leaves_the_list_as_it_is(listed) -> None:
    bpy.context.view_layer.update()
    bpy.ops.unisg.check()
    crate = bpy.data.objects["High"]
    listed.active = [item.name for item in listed.faults].index("High")
    assert bpy.ops.unisg.lock() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert not listed.old
    assert bpy.ops.unisg.action_add(type="Remove") == {"FINISHED"}
    bpy.context.view_layer.update()
    assert not listed.old
    crate.location.z += 1
    bpy.context.view_layer.update()
    assert listed.old
    bpy.ops.unisg.check()
    bpy.data.objects.remove(crate)
    bpy.context.view_layer.update()
    assert listed.old


def test_another_file_empties_the_list(listed) -> None:
    bpy.ops.unisg.check()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert not len(bpy.context.window_manager.unisg_check.faults)
    assert not bpy.ops.unisg.check.poll()
