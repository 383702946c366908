"""Panels are drawn often: what they ask of a scene is looked up once until something in it changes."""

from __future__ import annotations

import importlib
from collections import Counter
from collections.abc import Callable
from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import pytest

bpy = pytest.importorskip("bpy")
WALKS = ("scene_actions", "lesson_objects")


@pytest.fixture
def asked(extension: ModuleType, monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often the scene is gone through, by what for; a scene with an action of every slot and a lesson."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    for name in ("Knee", "Scalpel"):
        bpy.ops.mesh.primitive_cube_add()
        bpy.context.object.name = name
    bpy.data.objects["Knee"].select_set(True)
    bpy.ops.unisg.lesson_new(name="Surgery")
    bpy.ops.unisg.action_add(type="Tool")
    bpy.context.window_manager.unisg_pick_frame = bpy.data.objects["Knee"]
    bpy.ops.unisg.lesson_add_action()
    tool = extension.operators.action_properties.readable_actions(bpy.context.active_object)[0]
    bpy.ops.unisg.action_add(type="Parallel")
    bpy.ops.unisg.action_member(member=tool.uid)
    counts: Counter[str] = Counter()
    blender = f"{extension.__name__}.unisg_blender.blender"
    for module, name in (("lookup", "objects_by_uid"), *(("authoring.authoring", name) for name in WALKS)):
        home = importlib.import_module(f"{blender}.{module}")
        monkeypatch.setattr(home, name, counted(counts, name, getattr(home, name)))
    bpy.context.view_layer.update()
    return counts


def counted(counts: Counter[str], name: str, function: Callable[[object], object]) -> Callable[[object], object]:
    def told(scene: object) -> object:
        counts[name] += 1
        return function(scene)

    return told


def draw(extension: ModuleType) -> list[str]:
    """Draw the panels of actions and lessons, the buttons' own questions included; returns all labels."""
    layout = MagicMock()
    for name in ("row", "column", "box", "split"):
        getattr(layout, name).return_value = layout
    context = SimpleNamespace(
        region=SimpleNamespace(width=300),
        **{name: getattr(bpy.context, name) for name in ("scene", "window_manager", "active_object")},
    )
    panels = extension.panels
    for place in (0, 1):
        bpy.context.window_manager.unisg_action = place
        panels.object_actions.UNISG_PT_actions.draw(SimpleNamespace(layout=layout), context)
    for panel in (panels.lesson.UNISG_PT_lesson, panels.lesson.UNISG_PT_play):
        panel.draw(SimpleNamespace(layout=layout), context)
    for button in ("lesson_add", "lesson_remove", "lesson_move", "lesson_check", "play"):
        getattr(bpy.ops.unisg, button).poll()
    return [call.kwargs.get("text", "") for call in layout.label.call_args_list]


def test_a_redraw_looks_nothing_up_again(extension: ModuleType, asked: Counter[str]) -> None:
    first = draw(extension)
    assert asked == {"objects_by_uid": 1, "scene_actions": 1, "lesson_objects": 1}
    assert draw(extension) == first
    assert set(asked.values()) == {1}


def test_a_change_is_seen(extension: ModuleType, asked: Counter[str]) -> None:
    assert "moves with Knee" in draw(extension)
    bpy.data.objects["Knee"].name = "Elbow"
    bpy.context.view_layer.update()
    assert "moves with Elbow" in draw(extension)
    bpy.context.window_manager.unisg_action = 0
    bpy.ops.unisg.action_unlink(slot="frame")
    assert not any(text.startswith("moves with ") for text in draw(extension))
    bpy.context.window_manager.unisg_action = 0
    bpy.ops.unisg.action_link(slot="targets", name="Elbow")
    assert "Target: any of these" in draw(extension)
