"""What a model knows of somebody else's scene, in real Blender."""

from __future__ import annotations

from pathlib import Path

import pytest

bpy = pytest.importorskip("bpy")

from tests.words.foreign_scenes import kitchen  # noqa: E402
from unisg_blender.blender import write_scene  # noqa: E402
from unisg_blender.dataset import open_dataset  # noqa: E402


@pytest.fixture
def scene(extension):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    write_scene(kitchen(), bpy.context.scene)
    return bpy.context.scene


def test_what_is_known_is_told_and_shown(scene, extension) -> None:
    assert bpy.ops.unisg.understand(model="living_room") == {"FINISHED"}
    lines = extension.operators.making.understand.UNDERSTOOD[scene.name]
    assert lines[0] == "2 of 6 things in the scene are known to the model; it looks like a kitchen"
    assert "Stuhl_03 -> Chair" in lines


def test_a_mapping_file_changes_it(scene, extension, tmp_path: Path) -> None:
    path = tmp_path / "words.toml"
    path.write_text('[words]\nTable = "Coffee Table"\n\n[objects]\n"Cube.*" = "Plant"\n')
    assert bpy.ops.unisg.understand(model="living_room", words=str(path)) == {"FINISHED"}
    lines = extension.operators.making.understand.UNDERSTOOD[scene.name]
    assert lines[0].startswith("3 of 6 things")
    assert "Table -> Coffee Table, as the mapping says" in lines
    before = len(scene.objects)
    assert bpy.ops.unisg.generate(model="living_room", add="Tassen=1", words=str(path), seed=2, behaviour=False) == {
        "FINISHED"
    }
    assert len(scene.objects) == before + 1
    assert not scene.objects["Table"].get("unisg_category")
    with pytest.raises(RuntimeError, match=r"cannot read the mapping .*none\.toml"):
        bpy.ops.unisg.understand(model="living_room", words=str(tmp_path / "none.toml"))


def test_an_export_understands_when_asked(scene, tmp_path: Path) -> None:
    for understand in (False, True):
        folder = tmp_path / f"dataset-{understand}"
        assert bpy.ops.unisg.export_dataset(filepath=str(folder), understand=understand) == {"FINISHED"}
        names = open_dataset(folder).vocabulary["categories"]
        assert ("Refrigerator" in names, "Floor" in names) == (understand, understand)
