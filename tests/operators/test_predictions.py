"""The buttons that ask the networks, in real Blender."""

from __future__ import annotations

from pathlib import Path

import pytest

bpy = pytest.importorskip("bpy")

from unisg_blender.blender import read_scene  # noqa: E402
from unisg_blender.scene.properties import relations_of  # noqa: E402


@pytest.fixture
def stack(extension):
    """A small cube on a larger one."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    for name, size, height in (("below", 0.3, 0.15), ("above", 0.2, 0.4)):
        bpy.ops.mesh.primitive_cube_add(size=size, location=(0, 0, height))
        bpy.context.active_object.name = name
    return bpy.context.scene


def test_the_network_writes_what_is_on_what(stack) -> None:
    assert bpy.ops.unisg.relations(model="shipped") == {"FINISHED"}
    graph = read_scene(stack)
    found = [(item.kind, graph.name[graph.row_of_uid[item.target]]) for item in relations_of(graph, graph.row("above"))]
    assert found == [("on_top_of", "below")]
    assert not relations_of(graph, graph.row("below"))


def test_the_kind_of_scene_is_told_and_shown(stack, extension) -> None:
    assert bpy.ops.unisg.classify() == {"FINISHED"}
    assert extension.operators.classify.KINDS_OF[stack.name][0].startswith("none of these (0 of ")


def test_what_is_no_model_is_reported(stack, tmp_path: Path) -> None:
    for ask in (bpy.ops.unisg.relations, bpy.ops.unisg.classify):
        with pytest.raises(RuntimeError, match="there is no model"):
            ask(model=str(tmp_path / "missing.onnx"))
    assert "unisg_relations" not in bpy.data.objects["above"]


def test_an_empty_scene_has_no_kind(extension) -> None:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert not bpy.ops.unisg.classify.poll()
