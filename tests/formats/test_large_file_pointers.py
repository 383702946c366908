"""What Git LFS leaves where a file was not fetched is no damaged file: the user is told how to fetch it."""

from __future__ import annotations

from pathlib import Path

import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.formats import read_all_scenes, read_scene_file

POINTER = f"version https://git-lfs.github.com/spec/v1\noid sha256:{'4d' * 32}\nsize 5242880\n"

ENDINGS = ["glb", "gltf", "blend", "fbx", "obj", "usda", "usdc", "usdz", "json", "jsonl", "urdf", "xml", "dae", "stl"]


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("read", [read_scene_file, read_all_scenes])
def test_a_pointer_is_told(tmp_path: Path, ending: str, read) -> None:
    path = tmp_path / f"room.{ending}"
    path.write_text(POINTER)
    with pytest.raises(UniSGError, match=r"room\.\w+: it is only a pointer of Git LFS: `git lfs pull`"):
        read(path)


def test_a_mesh_of_a_layout_that_is_a_pointer_is_told(tmp_path: Path) -> None:
    (tmp_path / "table.dae").write_text(POINTER)
    (tmp_path / "room.urdf").write_text(
        '<robot name="room"><link name="table"><visual><geometry><mesh filename="table.dae"/></geometry></visual>'
        "</link></robot>"
    )
    assert "this mesh is only a pointer of Git LFS" in read_scene_file(tmp_path / "room.urdf")[1].summary()
