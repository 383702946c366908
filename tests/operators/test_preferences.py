"""What the preferences say is followed: models of one's own, which comes first, and where new objects go."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

bpy = pytest.importorskip("bpy")


@pytest.fixture
def preferences(extension: ModuleType, fresh_file: None) -> Iterator[object]:
    """Those of the extension, as if Blender listed it."""
    addon = bpy.context.preferences.addons.new()
    addon.module = extension.operators.preferences.NAME
    yield addon.preferences
    bpy.context.preferences.addons.remove(addon)


def place(**how: object) -> bpy.types.Object:
    chosen = {"category": "Chair", "model": "living_room", "how": "ANYWHERE", "seed": 1}
    assert bpy.ops.unisg.place(**{**chosen, **how}) == {"FINISHED"}
    return bpy.context.active_object


def test_new_objects_go_where_it_is_wished(preferences: object) -> None:
    bpy.ops.unisg.add_room(kind="living-room", seed=5)
    active = bpy.data.collections.new("Mine")
    bpy.context.scene.collection.children.link(active)
    bpy.context.view_layer.active_layer_collection = bpy.context.view_layer.layer_collection.children["Mine"]
    found = {}
    for home in ("ROOM", "ACTIVE", "OWN"):
        preferences.home = home  # type: ignore[attr-defined]
        found[home] = [each.name for each in place().users_collection]
    assert found == {"ROOM": ["Living Room"], "ACTIVE": ["Mine"], "OWN": ["UniSG"]}
    assert [each.name for each in place().users_collection] == ["UniSG"]


def test_models_of_a_folder_are_in_the_list_and_one_comes_first(
    preferences: object, extension: ModuleType, tmp_path: Path
) -> None:
    settings = extension.operators.making.generation_settings
    path = next(path for path in settings.shipped_models() if path.stem == "living_room")
    shutil.copy(path, tmp_path / "my_home.onnx")
    preferences.models, preferences.first = str(tmp_path), "My Home"  # type: ignore[attr-defined]
    listed = settings._models(None, bpy.context)
    assert listed[0][1] == "My home"
    assert {"Living room", "Operating room", "Own model"} <= {name for _, name, _ in listed}


def test_threads_are_those_of_the_preferences(preferences: object, extension: ModuleType) -> None:
    settings = extension.operators.making.generation_settings
    settings.load_generator("living_room")
    preferences.threads = 1  # type: ignore[attr-defined]
    assert not settings._generators
    assert settings._threads == [1]


def test_without_a_list_what_is_usual_counts(extension: ModuleType) -> None:
    module = extension.operators.preferences
    assert {name: module.preference(name) for name in module.DEFAULTS} == module.DEFAULTS
