"""What a button leaves out is what its operator says by default, not what was asked for the time before."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace

import pytest

bpy = pytest.importorskip("bpy")


@pytest.mark.parametrize(
    ("operator", "names"),
    [
        ("generate", ("model", "add", "on", "beside", "within", "seed", "bulk", "words", "behaviour")),
        ("add_room", ("seed",)),
        ("reroll", ("seed", "model", "words")),
        ("lock", ("how",)),
        ("assign_category", ("category",)),
        ("mark_room", ("kind", "number")),
        ("import_layout", ("filepath", "scene")),
        ("open_master_file", ("filepath",)),
        ("replay_file", ("filepath",)),
        ("replay", ("filepath",)),
        ("record", ("filepath", "playback")),
        ("action_link", ("name",)),
        ("lesson_new", ("name",)),
    ],
)
def test_nothing_is_taken_from_the_time_before(extension: ModuleType, operator: str, names: tuple[str, ...]) -> None:
    properties = getattr(bpy.ops.unisg, operator).get_rna_type().properties
    assert {name for name in names if not properties[name].is_skip_save} == set()


def test_the_panel_and_the_menu_ask_for_the_same(extension: ModuleType) -> None:
    settings = bpy.context.window_manager.unisg
    settings.counts.clear()
    settings.where = "ANYWHERE"
    assert settings.lacks(None) == "Set a count"
    for name, count in (("Chair", 2), ("Sofa", 0), ("Rug", 1)):
        item = settings.counts.add()
        item.name, item.count = name, count
    assert settings.lacks(None) == ""
    settings.where, settings.bulk, settings.seed = "BESIDE", True, 7
    assert settings.lacks(None) == "Select an object"
    asked = SimpleNamespace()
    settings.hand_over(asked, SimpleNamespace(name="Desk"))
    assert (asked.add, asked.beside, asked.on, asked.within) == ("Chair=2,Rug=1", "Desk", "", "")
    assert (asked.bulk, asked.seed) == (True, 7)
    settings.where, settings.room = "IN", " "
    assert settings.lacks(None) == "Choose a room"
    settings.room = "kitchen"
    settings.hand_over(asked, None)
    assert (asked.within, asked.beside) == ("kitchen", "")
    settings.where, settings.bulk, settings.seed, settings.room, settings.listed = "ANYWHERE", False, -1, "", ""
