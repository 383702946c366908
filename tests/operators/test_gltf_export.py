"""Blender's own glTF exporter carries the lesson when the extension is enabled."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

from tests.extension_package import NAME
from unisg_blender.blender import read_scene, write_scene
from unisg_blender.formats.gltf.gltf_container import unpacked
from unisg_blender.formats.scene_files import read_scene_file
from unisg_blender.interactivity import lesson_graph
from unisg_blender.worlds import living_room

pytestmark = pytest.mark.usefixtures("extension", "fresh_file")


@pytest.fixture(autouse=True)
def exporter(fresh_file: None) -> Iterator[None]:
    """Blender's exporter, and ours among the enabled add-ons."""
    import addon_utils

    addon_utils.enable("io_scene_gltf2")
    enabled = bpy.context.preferences.addons.new()
    enabled.module = NAME
    yield
    bpy.context.preferences.addons.remove(enabled)


def exported(path: Path, **settings: Any) -> dict[str, Any]:
    assert bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLB", **settings) == {"FINISHED"}
    return unpacked(path.read_bytes(), "it")[0]


def room() -> None:
    """A room in the current scene, with an object that is no part of it and comes first."""
    scene = write_scene(living_room(3))
    bpy.context.window.scene = scene
    other = bpy.data.objects.new("AAA", None)
    scene.collection.objects.link(other)


def test_the_lesson_goes_with_the_nodes_as_blender_numbers_them(tmp_path: Path) -> None:
    room()
    document = exported(tmp_path / "room.glb")
    assert {"KHR_interactivity", "KHR_node_selectability"} <= set(document["extensionsUsed"])
    scene, names = read_scene(), [node["name"] for node in document["nodes"]]
    numbers = [names.index(name) for name in scene.name]
    assert numbers != sorted(numbers)
    (graph,) = document["extensions"]["KHR_interactivity"]["graphs"]
    assert graph.pop("name")
    assert graph == lesson_graph(scene, node_of=numbers.__getitem__).graph
    assert graph != lesson_graph(scene).graph
    place = read_scene_file(tmp_path / "room.glb")[0]
    np.testing.assert_allclose([place.world[place.row_of_uid[uid]] for uid in scene.uid], scene.world, atol=1e-5)


def test_it_is_read_back_with_its_lesson_and_categories(tmp_path: Path) -> None:
    room()
    before = read_scene()
    exported(tmp_path / "room.glb")
    after, _ = read_scene_file(tmp_path / "room.glb")
    assert sorted(after.uid) == sorted(before.uid)
    assert [node for _, node in after.entries("lsa", "data")] == [node for _, node in before.entries("lsa", "data")]
    names = [
        {graph.uid[k]: graph.category_name(k) for k in np.flatnonzero(graph.category >= 0)} for graph in (after, before)
    ]
    assert names[0] == names[1]


def test_what_is_not_exported_or_not_wanted(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    room()
    bpy.ops.object.select_all(action="DESELECT")
    bpy.data.objects["AAA"].select_set(True)
    assert "extensions" not in exported(tmp_path / "some.glb", use_selection=True)
    assert re.search("is not in the file: export it too", capfd.readouterr().out)
    assert "extensions" not in exported(tmp_path / "z.glb", export_yup=False)
    assert "tick +Y Up" in capfd.readouterr().out
    bpy.context.scene.unit_settings.scale_length = 0.01
    assert "extensions" not in exported(tmp_path / "unit.glb")
    assert "Unit Scale" in capfd.readouterr().out
    bpy.context.scene.unit_settings.scale_length = 1.0
    bpy.context.window_manager.unisg_gltf_lesson = False
    try:
        assert "extensions" not in exported(tmp_path / "off.glb")
    finally:
        bpy.context.window_manager.unisg_gltf_lesson = True


def test_what_cannot_be_carried_is_said_before(extension) -> None:
    from importlib import import_module
    from types import SimpleNamespace

    module = import_module(f"{NAME}.operators.interchange.gltf_lesson")
    room()
    scene = bpy.context.scene
    assert [line for line in module.not_carried(scene) if "separating axes" not in line] == []
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    scene.collection.objects.link(lamp)
    exporter = SimpleNamespace(export_yup=False, use_selection=True)
    for item in scene.objects:
        item.select_set(False)
    lines = module.left_out(scene, exporter)
    assert "+Y Up" in lines[0]
    assert len(lines) > 1
    scene.unit_settings.scale_length = 0.5
    bpy.context.view_layer.update()
    module._told.clear()
    assert "Unit Scale" in module.not_carried(scene)[0]
