"""SceneGraph -> USD -> SceneGraph loses nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from tests.usd.compare import assert_same_graph
from tests.usd.random_scenes import scenes
from unisg_blender.scene import SceneBuilder, SceneGraph, mesh_from_faces, table
from unisg_blender.usd import read_usd, write_usd

RELAXED = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow, HealthCheck.data_too_large]


@pytest.mark.slow
@given(graph=scenes())
@settings(max_examples=40, deadline=None, suppress_health_check=RELAXED)
def test_any_scene_survives(tmp_path: Path, graph: SceneGraph) -> None:
    for ending in ("usda", "usdc"):
        path = tmp_path / f"scene.{ending}"
        write_usd(graph, path)
        assert_same_graph(graph, read_usd(path))


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["usd", "usdz"])
@given(graph=scenes())
@settings(max_examples=4, deadline=None, suppress_health_check=RELAXED)
def test_other_endings(tmp_path: Path, ending: str, graph: SceneGraph) -> None:
    path = tmp_path / f"scene.{ending}"
    write_usd(graph, path)
    assert_same_graph(graph, read_usd(path))


def test_writing_twice_gives_the_same_text(tmp_path: Path) -> None:
    builder = SceneBuilder("Room")
    box = mesh_from_faces("Box", np.eye(3), [[0, 1, 2]])
    table_row = builder.add("Table", uid="t", mesh=box, category="Table")
    builder.add("Cup", uid="c", parent=table_row, mesh=box)
    write_usd(builder.build(), tmp_path / "first.usda")
    write_usd(read_usd(tmp_path / "first.usda"), tmp_path / "second.usda")
    assert (tmp_path / "first.usda").read_text() == (tmp_path / "second.usda").read_text()


def test_instances_share_their_prototype(tmp_path: Path) -> None:
    """A prototype that holds instances itself, a few turned copies and many upright ones."""
    leaf = SceneBuilder("Leaf")
    leaf.add("Leaf", uid="leaf", mesh=mesh_from_faces("Leaf", np.eye(3), [[0, 1, 2]]))
    branch = SceneBuilder("Branch")
    branch.add("Branch", uid="branch")
    leaves = leaf.build()
    turned = np.array([[0, -1, 0, 1], [1, 0, 0, 2], [0, 0.5, 1, 3], [0, 0, 0, 1]], float)
    inner = branch.build().with_component(
        "instances",
        table([0, 0], prototype=[leaves] * 2, matrix=np.stack([np.eye(4), turned]), source=["COLLECTION"] * 2),
    )
    many = np.tile(np.eye(4), (20, 1, 1))
    many[:, 0, 3] = np.linspace(0, 1, 20) / 3
    many[:, 1, 1] = -2.0
    builder = SceneBuilder("Tree")
    builder.add("Tree", uid="tree", local=turned)
    rows = [0] * 22
    graph = builder.build().with_component(
        "instances",
        table(
            rows,
            prototype=[inner, inner, *[leaves] * 20],
            matrix=np.concatenate([np.stack([turned, np.eye(4)]), many]),
            source=["COLLECTION"] * 2 + ["GEOMETRY"] * 20,
        ),
    )
    write_usd(graph, tmp_path / "tree.usda")
    found = read_usd(tmp_path / "tree.usda")
    assert_same_graph(graph, found)
    prototypes = found.components["instances"].columns["prototype"]
    assert len({id(prototype) for prototype in prototypes}) == 2
    nested = prototypes[0].components["instances"].columns["prototype"][0]
    assert nested is prototypes[-1]
    text = (tmp_path / "tree.usda").read_text()
    assert text.count("point3f[] points") == 1
    assert "def PointInstancer" in text
    assert "instanceable = true" in text


def test_empty_scene(tmp_path: Path) -> None:
    write_usd(SceneBuilder("Nothing").build(), tmp_path / "empty.usda")
    found = read_usd(tmp_path / "empty.usda")
    assert len(found) == 0
    assert found.title == "Nothing"
