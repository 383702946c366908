"""Entries in Blender's own menus: there while the extension is, each with an operator that exists."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import pytest

bpy = pytest.importorskip("bpy")


def entries(menu: str) -> list[object]:
    """The functions that draw into one of Blender's menus."""
    drawn = getattr(getattr(bpy.types, menu), "_dyn_ui_initialize", None)
    return list(getattr(bpy.types, menu).draw._draw_funcs) if drawn is not None else []


def asked(draw: object) -> set[str]:
    """The operators and menus that a draw function puts into its layout."""
    layout = MagicMock()
    draw(SimpleNamespace(layout=layout), bpy.context)
    calls = [*layout.operator.call_args_list, *layout.menu.call_args_list, *layout.operator_menu_enum.call_args_list]
    return {call.args[0] for call in calls}


def test_menus_have_entries_as_long_as_the_extension_is_enabled(extension: ModuleType) -> None:
    menus = extension.panels.menus
    for place, draw in menus.PLACES:
        assert draw in entries(place)
    menus.unregister()
    assert all(draw not in entries(place) for place, draw in menus.PLACES)
    menus.register()
    for place, draw in menus.PLACES:
        assert entries(place).count(draw) == 1


def test_every_entry_names_what_there_is(extension: ModuleType) -> None:
    menus = extension.panels.menus
    found = set().union(*(asked(draw) for _, draw in menus.PLACES), *(asked(cls.draw) for cls in menus.CLASSES))
    assert {"UNISG_MT_add", "UNISG_MT_object", "unisg.settle", "unisg.add_room", "unisg.convert"} <= found
    for name in found:
        if name.startswith("unisg."):
            assert hasattr(bpy.types, f"UNISG_OT_{name.split('.')[1]}")
        else:
            assert hasattr(bpy.types, name)
