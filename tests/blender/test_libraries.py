"""Objects linked from other files."""

from __future__ import annotations

from pathlib import Path

import bpy

from tests.blender.helpers import add, assert_same_scene, box
from unisg_blender.blender import new_file, read_file, read_scene, save_blend, write_scene


def test_linked_objects_are_read_and_named_as_such(tmp_path: Path) -> None:
    parent = add("Parent")
    parent.location = (1, 2, 3)
    add("Child", box(), parent)
    save_blend(tmp_path / "library.blend")
    new_file()
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.objects = ["Parent", "Child"]
    for item in wanted.objects:
        bpy.context.scene.collection.objects.link(item)
    add("Child", box("Local"))
    save_blend(tmp_path / "scene.blend")

    graph, report = read_file(tmp_path / "scene.blend")
    assert graph.name == ("Child", "Parent", "Child")
    assert len(set(graph.uid)) == 3
    linked = graph.components["library"]
    assert linked.rows.tolist() == [1, 2]
    assert all(path.endswith("library.blend") for path in linked.columns["path"])
    assert any("Parent: linked from" in line for line in report)
    assert graph[2].world[:3, 3].tolist() == [1, 2, 3]
    new_file()
    assert_same_scene(graph, read_scene(write_scene(graph)))


def test_a_missing_library_does_no_harm(tmp_path: Path) -> None:
    add("Thing", box())
    save_blend(tmp_path / "library.blend")
    new_file()
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.objects = ["Thing"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    save_blend(tmp_path / "scene.blend")
    (tmp_path / "library.blend").unlink()
    graph, report = read_file(tmp_path / "scene.blend")
    assert graph.name == ("Thing",)
    assert any("library.blend" in line for line in report)
