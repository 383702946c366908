"""Many copies that are not turned are a point instancer; others, whose turns it would keep coarsely, are not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.meshes.shapes import box
from unisg_blender.scene import SceneBuilder, SceneGraph, Table
from unisg_blender.usd import read_usd, write_usd
from unisg_blender.usd.write.instance_specs import FEW, upright


def grass(count: int, turn: float = 0.0) -> SceneGraph:
    blade, builder = SceneBuilder("blade"), SceneBuilder("field")
    blade.add("Blade", uid="b", mesh=box((0.1, 0.1, 0.5)))
    builder.add("Field", uid="f")
    places = np.tile(np.eye(4), (count, 1, 1))
    places[:, 0, 3] = np.arange(count)
    places[-1, :2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    shown, source = np.empty(count, object), np.array(["GEOMETRY"] * count, object)
    prototype = blade.build()
    for place in range(count):
        shown[place] = prototype
    table = Table(np.zeros(count, np.int32), {"prototype": shown, "matrix": places, "source": source})
    graph = builder.build()
    return graph.replace(components={**graph.components, "instances": table})


@pytest.mark.parametrize(
    ("count", "turn", "instancer"), [(FEW + 1, 0.0, True), (FEW, 0.0, False), (FEW + 1, 0.3, False), (1, 0.3, False)]
)
def test_how_copies_are_written(tmp_path: Path, count: int, turn: float, instancer: bool) -> None:
    graph = grass(count, turn)
    write_usd(graph, tmp_path / "field.usda")
    text = (tmp_path / "field.usda").read_text()
    assert ("def PointInstancer" in text) == instancer
    again = read_usd(tmp_path / "field.usda").components["instances"]
    found = np.array(sorted(again.columns["matrix"].reshape(-1, 16).tolist(), key=lambda m: m[3]))
    np.testing.assert_allclose(found.reshape(-1, 4, 4), graph.components["instances"].columns["matrix"], atol=1e-5)


def test_only_matrices_along_the_axes_are_upright() -> None:
    assert upright(np.stack([np.diag([2.0, 3, 4, 1]), np.eye(4)]))
    sheared = np.eye(4)
    sheared[0, 1] = 1e-6
    assert not upright(np.stack([np.eye(4), sheared]))


def test_faces_by_slot_are_subsets_named_after_it(tmp_path: Path) -> None:
    builder = SceneBuilder("two colours")
    cube = replace(box(), material_index=np.array([0, 1, 0, 1, 0, 1], np.int32), materials=("red", "blue"))
    builder.add("Cube", uid="c", mesh=cube)
    write_usd(builder.build(), tmp_path / "cube.usda")
    text = (tmp_path / "cube.usda").read_text()
    assert 'def GeomSubset "slot_0"' in text
    assert 'def GeomSubset "slot_1"' in text
    assert "slot_minus" not in text
    again = read_usd(tmp_path / "cube.usda")
    assert again.meshes[0].material_index.tolist() == [0, 1, 0, 1, 0, 1]
