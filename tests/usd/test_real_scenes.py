"""Blender -> SceneGraph -> USD -> SceneGraph loses nothing of real scenes: every column, mesh and component agrees."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.conftest import scene_files
from tests.usd.compare import assert_same_graph
from unisg_blender.usd import read_usd, write_usd

pytest.importorskip("bpy")

from unisg_blender.blender import read_file, sample_animation

DATA = Path(__file__).parents[1] / "data"
KINDS = (".blend", ".glb", ".gltf", ".usd", ".usda", ".usdz")
SCENES = sorted(path for path in [*DATA.rglob("*"), *scene_files()] if path.suffix in KINDS)
FRAMES = (1, 2, 5, 10)


@pytest.mark.parametrize("path", SCENES, ids=[f"{path.parent.name}/{path.name}" for path in SCENES])
def test_real_scene(path: Path, tmp_path: Path) -> None:
    graph = sample_animation(read_file(path)[0], frames=FRAMES)
    write_usd(graph, tmp_path / "scene.usdc")
    assert_same_graph(graph, read_usd(tmp_path / "scene.usdc"))
