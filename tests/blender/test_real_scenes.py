"""Files that others made: all are read, and keep hierarchy, matrices and meshes on the way through a scenegraph."""

from __future__ import annotations

import os
from pathlib import Path

import bpy
import numpy as np
import pytest

from tests.blender.helpers import assert_same_scene, assert_stands_like_blender
from unisg_blender.blender import SUFFIXES, new_file, read_file, read_scene, read_scenes, write_scene

DATA = Path(__file__).parents[1] / "data"


def _files() -> list[Path]:
    folders = [DATA, *([Path(os.environ["UNISG_SCENES"])] if os.environ.get("UNISG_SCENES") else [])]
    return sorted(path for folder in folders for path in folder.rglob("*") if path.suffix in SUFFIXES)


@pytest.fixture(scope="module", params=_files(), ids=lambda path: f"{path.parent.name}/{path.name}")
def opened(request):
    graph, report = read_file(request.param)
    return graph, report


@pytest.fixture(autouse=True)
def fresh_file() -> None:
    """Not here: one opened file serves several tests."""


def test_hierarchy_and_world_matrices(opened) -> None:
    assert_stands_like_blender(opened[0])


def test_the_same_file_gives_the_same_graph(opened) -> None:
    again = read_scene()
    assert again.name == opened[0].name
    assert again.uid == opened[0].uid
    assert again.local.tobytes() == opened[0].local.tobytes()


def test_reading_writes_nothing(opened) -> None:
    assert not any("unisg_uid" in item.keys() for item in bpy.context.scene.objects)  # noqa: SIM118  no mapping


def test_mesh_arrays_are_sound(opened) -> None:
    for mesh in opened[0].meshes:
        assert mesh.offsets[0] == 0
        assert mesh.offsets[-1] == len(mesh.corners)
        assert (np.diff(mesh.offsets) > 2).all()
        assert mesh.corners.max(initial=-1) < len(mesh.points)
        assert mesh.normals is None or mesh.normals.shape == (len(mesh.corners), 3)


def test_there_and_back(opened) -> None:
    graphs = read_scenes(geometry="original")
    new_file()
    for graph in graphs.values():
        assert_same_scene(graph, read_scene(write_scene(graph), geometry="original"))
