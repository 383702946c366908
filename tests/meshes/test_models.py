from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.learn.atlasnet.world_shapes import world_models
from unisg_blender.meshes.mesh_files import read_mesh_file
from unisg_blender.meshes.shape_files import SPLITS, TABLE, of_split, read_models

DATA = Path(__file__).resolve().parents[1] / "data" / "meshes"


def test_known_models_have_category_split_and_real_size() -> None:
    models = {model.name: model for model in read_models([DATA])}
    assert len(models) == 6
    chair = models["Chair"]
    assert (chair.category, chair.split) == ("Chair", "train")
    assert np.allclose(np.ptp(chair.mesh.bounds, axis=0), (0.484, 0.442, 0.884), atol=1e-4)
    assert models["couch"].split == "test"
    assert models["Table"].category == "Dining Table"


def test_z_is_up() -> None:
    chair = read_mesh_file(DATA / "kaykit" / "Furniture" / "chair_A.gltf")
    assert np.ptp(chair.bounds, axis=0)[2] > 1.2
    assert len(chair.triangles) == 308


def test_table_of_models_is_sound() -> None:
    import csv

    with open(TABLE, newline="", encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    assert len({row["file"] for row in rows}) == len(rows) == 712
    assert {row["split"] for row in rows} == set(SPLITS)
    families: dict[str, set[str]] = {}
    for row in rows:
        families.setdefault(row["family"], set()).add(row["split"])
        assert row["author"]
        assert row["licence"].startswith("CC")
        assert all(float(row[side]) > 0 for side in ("width", "depth", "height"))
    assert all(len(splits) == 1 for splits in families.values())
    trained = {row["category"] for row in rows if row["split"] == "train"}
    assert not trained & {row["category"] for row in rows if row["split"] == "unseen"}


def test_other_files_have_the_category_of_their_folder(tmp_path: Path) -> None:
    for name in ("Lamp/one", "Lamp/two", "loose"):
        path = tmp_path / f"{name}.obj"
        path.parent.mkdir(exist_ok=True)
        path.write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n")
    models = read_models([tmp_path])
    assert [(model.name, model.category) for model in models] == [("one", "Lamp"), ("two", "Lamp"), ("loose", "")]
    assert np.allclose(np.ptp(models[0].mesh.bounds, axis=0), (1, 0, 2))
    assert len(of_split(models, "train")) + len(of_split(models, "test")) == 3


def test_meshes_of_rooms_once_each() -> None:
    models = world_models(["operating-room"], 2)
    assert len({model.mesh.checksum for model in models}) == len(models) > 20
    assert {"Scalpel", "Operating Table"} <= {model.category for model in models}


@pytest.mark.parametrize("text", ["", "not a mesh at all"])
def test_damaged_files(tmp_path: Path, text: str) -> None:
    for suffix in (".obj", ".ply", ".glb", ".gltf", ".stl", ".off"):
        path = tmp_path / f"broken{suffix}"
        path.write_text(text)
        with pytest.raises(UniSGError, match="broken"):
            read_mesh_file(path)


def test_unusable_folders(tmp_path: Path) -> None:
    with pytest.raises(UniSGError, match="no such folder"):
        read_models([tmp_path / "missing"])
    with pytest.raises(UniSGError, match="no mesh files here"):
        read_models([tmp_path])
    with pytest.raises(UniSGError, match="no such file"):
        read_mesh_file(tmp_path / "missing.obj")
    with pytest.raises(UniSGError, match="not a mesh file"):
        read_mesh_file(tmp_path / "scene.blend")
    with pytest.raises(UniSGError, match="no world 'moon'"):
        world_models(["moon"], 1)


def test_a_file_of_points_is_a_mesh_without_faces(tmp_path: Path) -> None:
    path = tmp_path / "cloud.ply"
    path.write_text(
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n0 0 0\n1 2 3\n"
    )
    mesh = read_mesh_file(path)
    assert len(mesh.points) == 2
    assert len(mesh.triangles) == 0
