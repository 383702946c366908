"""Meshes that are no meshes, on the command line: a clear error or a documented fallback, and nothing is lost."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.cli import main
from unisg_blender.scene import SceneGraph, mesh_from_faces
from unisg_blender.scene.builder import SceneBuilder
from unisg_blender.usd.pxr_library import missing_pxr

from .shapes import box

POINTS = np.random.default_rng(0).random((50, 3))


def odd_scene() -> SceneGraph:
    """An object with a broken corner, a point cloud, an empty mesh, a face without area."""
    sound = box()
    faces = [*sound.corners.reshape(-1, 4).tolist(), [0, 1, 8]]
    meshes = {
        "broken": mesh_from_faces("broken", np.vstack([sound.points, [[np.nan, 0, 0]]]), faces),
        "cloud": mesh_from_faces("cloud", POINTS, []),
        "empty": mesh_from_faces("empty", np.zeros((0, 3)), []),
        "line": mesh_from_faces("line", [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]),
    }
    builder = SceneBuilder()
    for name, mesh in meshes.items():
        builder.add(name, uid=name, mesh=mesh)
    return builder.build()


@pytest.mark.filterwarnings("ignore:/Scene/broken/broken. some points are not finite:UserWarning")
def test_label_falls_back_on_the_points_and_keeps_all_geometry(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if missing_pxr():
        pytest.skip(missing_pxr())
    from unisg_blender.usd import read_usd, write_usd

    write_usd(odd_scene(), tmp_path / "in.usda")
    before = read_usd(tmp_path / "in.usda")
    arguments = ["label", str(tmp_path / "in.usda"), "--json", "--out", str(tmp_path / "out.usda"), "--threshold", "0"]
    assert main(arguments) == 0
    (report,) = json.loads(capsys.readouterr().out)["files"]
    proposals = {found["name"]: found["categories"] for found in report["proposals"]}
    assert set(proposals) == {"broken", "cloud", "line"}
    assert np.isfinite([guess["confidence"] for found in proposals.values() for guess in found]).all()
    after = read_usd(tmp_path / "out.usda")
    for name in ("broken", "cloud", "line"):
        own, other = (graph.meshes[graph.mesh[graph.name.index(name)]] for graph in (before, after))
        assert np.array_equal(own.points, other.points, equal_nan=True)
        assert np.array_equal(own.corners, other.corners)


@pytest.mark.slow
def test_export_gives_each_entity_a_finite_feature(tmp_path: Path) -> None:
    if missing_pxr():
        pytest.skip(missing_pxr())
    from unisg_blender.dataset import open_dataset
    from unisg_blender.usd import write_usd

    write_usd(odd_scene(), tmp_path / "in.usda")
    out = tmp_path / "data"
    assert main(["export", str(tmp_path / "in.usda"), "--out", str(out), "--mesh-features", "atlasnet", "-q"]) == 0
    features = open_dataset(out)[0]["mesh.feature"]
    assert features.shape[1] == 1024
    assert np.isfinite(features).all()
    assert {bool(row.any()) for row in features} == {True, False}  # zeros for the mesh without points


@pytest.mark.parametrize(
    ("text", "message"),
    [("v nan 0 0\nv nan 1 0\nv nan 0 1\nf 1 2 3\n", "has no points"), ("# nothing\n", "holds no geometry")],
)
def test_training_refuses_what_has_no_points(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, message: str
) -> None:
    pytest.importorskip("onnxscript")
    (tmp_path / "data" / "Odd").mkdir(parents=True)
    (tmp_path / "data" / "Odd" / "thing.obj").write_text(text)
    out = tmp_path / "out"
    words = ["train", "meshes", "--data", str(tmp_path / "data"), "--out", str(out), "--steps", "2", "--rooms", "0"]
    assert main([*words, "-q"]) == 1
    assert message in capsys.readouterr().err
    assert not out.exists() or not list(out.iterdir())
