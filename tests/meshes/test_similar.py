from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.meshes.similar import folder_library, mesh_library
from unisg_blender.scene import mesh_from_faces

from .shapes import CUBE_FACES, box, sphere

DATA = Path(__file__).resolve().parents[1] / "data" / "meshes"


def test_nearest_of_a_library() -> None:
    library = mesh_library(["cube", "plank", "ball"], [box(), box((3, 0.3, 0.1)), sphere(400)])
    found = library.nearest(box((2.7, 0.3, 0.1)), 3)
    assert found[0].name == "plank"
    assert [match.distance for match in found] == sorted(match.distance for match in found)
    assert library.nearest(box((0.3, 2.7, 0.1)), 1)[0].name == "plank"  # a quarter turn


def test_size_breaks_ties_of_shape() -> None:
    library = mesh_library(["small", "large"], [box((0.1, 0.1, 0.1)), box((2, 2, 2))])
    assert library.nearest(box((1.9, 1.9, 1.9)), 1)[0].name == "large"


def test_library_of_a_folder(tmp_path: Path) -> None:
    problems: list[str] = []
    (tmp_path / "broken.ply").write_text("ply")
    library = folder_library(DATA)
    assert len(library.names) == 6
    chair = next(name for name in library.names if name.endswith("chair_A.gltf"))
    from unisg_blender.meshes.mesh_files import read_mesh_file

    match = library.nearest(read_mesh_file(chair), 1)[0]
    assert match.name == chair
    assert match.distance < 1e-3
    with pytest.raises(UniSGError, match="no mesh files that can be read"):
        folder_library(tmp_path, skipped=problems.append)
    assert len(problems) == 1
    with pytest.raises(UniSGError, match="no such folder"):
        folder_library(tmp_path / "missing")


def test_nothing_to_compare() -> None:
    empty = mesh_from_faces("empty", np.zeros((0, 3)), [])
    library = mesh_library(["empty"], [empty])
    assert library.names == ()
    with pytest.raises(UniSGError, match="no meshes"):
        library.nearest(box())
    with pytest.raises(UniSGError, match="no points"):
        mesh_library(["cube"], [mesh_from_faces("cube", box().points, CUBE_FACES)]).nearest(empty)
