"""The panel says where each category's shapes come from, and offers to choose."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import pytest

bpy = pytest.importorskip("bpy")


def labels(extension: ModuleType) -> list[str]:
    layout = MagicMock()
    for name in ("row", "column"):
        getattr(layout, name).return_value = layout
    panel = extension.panels.where_from.UNISG_PT_shapes
    panel.draw(SimpleNamespace(layout=layout), bpy.context)
    return [call.kwargs["text"] for call in layout.label.call_args_list]


def test_it_says_for_what_is_wanted_and_chosen_where_it_comes_from(extension: ModuleType) -> None:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    settings = bpy.context.window_manager.unisg
    settings.counts.clear()
    assert labels(extension)[0].startswith("Set a count")
    for name in ("Chair", "Cup", "Lamp"):
        item = settings.counts.add()
        item.name, item.count = name, int(name == "Cup")
    settings.active = 0
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.name, bpy.context.object["unisg_category"] = "Mug", "Chair"
    assert bpy.ops.unisg.choose_shape(category="Cup") == {"FINISHED"}
    assert "Cup: the model's own" in labels(extension)
    bpy.context.scene.unisg_shapes["Cup"].object = bpy.context.object
    found = labels(extension)
    assert {"Cup: Mug, chosen", "Chair: those of the scene"} <= set(found)
    assert not [text for text in found if text.startswith("Lamp")]
    settings.counts.clear()
