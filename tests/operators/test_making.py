"""Locking, placing anew and suggesting from Blender."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")


SEED = 3
"""Of the fixture ``room``."""


def thing(category: str) -> bpy.types.Object:
    return next(item for item in bpy.context.scene.objects if item.get("unisg_category") == category)


def select(*items: bpy.types.Object) -> None:
    bpy.ops.object.select_all(action="DESELECT")
    for item in items:
        item.select_set(True)
        bpy.context.view_layer.objects.active = item


def places() -> dict[str, np.ndarray]:
    bpy.context.view_layer.update()
    return {item.name: np.array(item.matrix_world) for item in bpy.context.scene.objects}


def changed(before: dict[str, np.ndarray]) -> set[str]:
    return {name for name, world in places().items() if not np.allclose(world, before[name], atol=1e-6)}


def test_a_lock_survives_saving_and_keeps_a_thing_where_it_is(room: None, tmp_path: Path) -> None:
    chair = thing("Chair")
    select(chair)
    assert bpy.ops.unisg.lock() == {"FINISHED"}
    chair.location.z += 0.5
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "locked.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "locked.blend"))
    select(thing("Chair"))
    before = places()
    assert bpy.ops.unisg.settle() == {"CANCELLED"}
    assert bpy.ops.unisg.reroll(seed=1, model="living_room") == {"CANCELLED"}
    assert changed(before) == set()
    assert bpy.ops.unisg.lock() == {"FINISHED"}
    assert "unisg_lock" not in thing("Chair")
    assert bpy.ops.unisg.settle() == {"FINISHED"}
    assert changed(before) == {thing("Chair").name}


def test_selected_things_are_placed_anew_and_the_rest_stays(room: None) -> None:
    book, chair = thing("Book"), thing("Chair")
    select(book, chair)
    before, scale = places(), tuple(chair.scale)
    assert bpy.ops.unisg.reroll(seed=2, model="living_room") == {"FINISHED"}
    below = {part.name for part in (*book.children_recursive, *chair.children_recursive)}
    assert {book.name, chair.name} <= changed(before) <= {book.name, chair.name} | below
    assert tuple(chair.scale) == pytest.approx(scale)
    assert set(bpy.context.selected_objects) == {book, chair}
    middle = book.matrix_world.translation
    assert book.parent is None or (book.parent.matrix_world.translation - middle).length < 3


def test_what_stands_on_it_moves_along(room: None) -> None:
    table = thing("Coffee Table")
    on_it = [item for item in table.children if item.get("unisg_category")]
    offsets = [table.matrix_world.inverted() @ item.matrix_world for item in on_it]
    select(table)
    assert bpy.ops.unisg.reroll(seed=1, model="living_room") == {"FINISHED"}
    bpy.context.view_layer.update()
    assert on_it
    for item, offset in zip(on_it, offsets, strict=True):
        np.testing.assert_allclose(
            np.array(table.matrix_world.inverted() @ item.matrix_world), np.array(offset), atol=1e-5
        )


def drawn(extension: ModuleType) -> list[SimpleNamespace]:
    """The buttons that the panel Suggest has."""
    layout, made = MagicMock(), []
    for name in ("row", "column", "split"):
        getattr(layout, name).return_value = layout

    def operator(name: str, **_: object) -> SimpleNamespace:
        made.append(SimpleNamespace(name=name))
        return made[-1]

    layout.operator.side_effect = operator
    context = SimpleNamespace(
        region=SimpleNamespace(width=400), scene=bpy.context.scene, window_manager=bpy.context.window_manager
    )
    extension.panels.suggest.UNISG_PT_suggest.draw(SimpleNamespace(layout=layout), context)
    return [each for each in made if each.name == "unisg.generate"]


def test_what_is_missing_is_listed_and_a_click_places_it(extension: ModuleType, room: None) -> None:
    settings, found = bpy.context.window_manager.unisg, bpy.context.window_manager.unisg_suggested
    extension.operators.making.generation_settings.choose_model(bpy.context, "living_room")
    sofa = thing("Sofa")
    for item in (*sofa.children_recursive, sofa):
        bpy.data.objects.remove(item)
    assert bpy.ops.unisg.suggest() == {"FINISHED"}
    assert found.things[0].name == "Sofa"
    assert found.things[0].share > 0.5
    button = drawn(extension)[0]
    assert (button.add, button.model) == ("Sofa=1", settings.model)
    assert bpy.ops.unisg.generate(add=button.add, model=button.model, seed=1) == {"FINISHED"}
    assert thing("Sofa")
    assert not drawn(extension), "what was suggested is old"
    bpy.ops.unisg.suggest()
    assert not found.things or found.things[0].name != "Sofa"


def test_suggestions_are_for_the_chosen_model_and_for_what_is_there(extension: ModuleType, room: None) -> None:
    settings = extension.operators.making.generation_settings
    settings.choose_model(bpy.context, "living_room")
    bpy.ops.unisg.suggest()
    assert drawn(extension)
    settings.choose_model(bpy.context, "operating_room")
    assert not drawn(extension), "they were another model's"
    settings.choose_model(bpy.context, "living_room")
    assert drawn(extension)
    found = bpy.context.window_manager.unisg_suggested
    assert found.objects == len(bpy.context.scene.objects)
    bpy.ops.unisg.add_room(kind="living-room", seed=4)
    assert not drawn(extension), "what was suggested is old"


def test_another_file_empties_the_suggestions(extension: ModuleType, room: None) -> None:
    extension.operators.making.generation_settings.choose_model(bpy.context, "living_room")
    bpy.ops.unisg.suggest()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert not len(bpy.context.window_manager.unisg_suggested.things)
    assert not drawn(extension)


def test_another_file_empties_proposals_and_what_was_found(extension: ModuleType) -> None:
    settings = bpy.context.window_manager.unisg_meshes
    settings.proposals.add().name = "Cube"
    settings.matches.add().name = "Cube"
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    settings = bpy.context.window_manager.unisg_meshes
    assert (len(settings.proposals), len(settings.matches)) == (0, 0)
