"""What another tool changes in a master file counts; what it leaves alone stays exact."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.usd.compare import assert_same_graph
from unisg_blender.scene import SceneBuilder, SceneGraph, mesh_from_faces, table, world_matrices
from unisg_blender.scene.graph import TYPE_INDEX
from unisg_blender.usd import read_usd, write_usd
from unisg_blender.usd.cameras import NEW as CAMERA
from unisg_blender.usd.light_units import NEW as LIGHT
from unisg_blender.usd.pxr_library import require_pxr

TRIANGLE = mesh_from_faces("Triangle", np.eye(3), [[0, 1, 2]])
CAMERA_VALUES = {"data": "Eye", "active": True, "fit": "VERTICAL", "shift_x": 0.1, "lens": 1 / 3, "fstop": 1.7}
KINDS = ("POINT", "SUN", "SPOT", "AREA")


def moved(x: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


def columns(entries: list[dict[str, Any]]) -> dict[str, Any]:
    """Columns of a component table, typed like its values."""
    made = {}
    for key, example in entries[0].items():
        values = [entry[key] for entry in entries]
        kind = bool if isinstance(example, bool) else float
        made[key] = values if isinstance(example, str) else np.array(values, kind)
    return made


def studio() -> SceneGraph:
    """Two cameras, a light of each kind, hidden objects, an object that a constraint holds, and instances."""
    builder = SceneBuilder("Studio")
    for name in ("Eye", "Ortho", *KINDS):
        builder.add(name, uid=name)
    for name in ("Hidden", "Shown", "Held", "Forest"):
        builder.add(name, uid=name, mesh=None if name == "Forest" else TRIANGLE, local=moved(1.0))
    graph = builder.build()
    eyes = [CAMERA | CAMERA_VALUES, CAMERA | {"kind": "ORTHO", "focused": True, "ortho_scale": 0.7}]
    lights = [LIGHT | {"kind": kind, "energy": 1 / 7, "tinted": True, "shadow": kind != "SUN"} for kind in KINDS]
    lights[KINDS.index("AREA")]["shape"] = "SQUARE"
    tree = SceneBuilder("Tree")
    tree.add("Tree", uid="tree", mesh=TRIANGLE)
    copies = np.array([moved(x / 3) for x in range(12)])
    tables = {
        "camera": table([graph.row("Eye"), graph.row("Ortho")], **columns(eyes)),
        "light": table([graph.row(kind) for kind in KINDS], **columns(lights)),
        "visibility": table([graph.row("Hidden")], hidden=np.ones(1, bool), viewport=np.zeros(1, bool),
                            render=np.zeros(1, bool)),
        "world": table([graph.row("Held")], matrix=moved(1 / 3)[None]),
        "instances": table([graph.row("Forest")] * 12, prototype=[tree.build()] * 12, matrix=copies,
                           source=["GEOMETRY"] * 12),
    }  # fmt: skip
    types = graph.type.copy()
    types[tables["camera"].rows], types[tables["light"].rows] = TYPE_INDEX["CAMERA"], TYPE_INDEX["LIGHT"]
    return graph.replace(type=types, components=tables)


def edited(folder: Path, edit: Callable[[Any], None]) -> SceneGraph:
    """The studio after another tool has changed its file."""
    require_pxr()
    from pxr import Usd

    path = folder / "studio.usda"
    write_usd(studio(), path)
    stage = Usd.Stage.Open(str(path))
    edit(stage)
    stage.GetRootLayer().Save()
    del stage
    return read_usd(path)


def put(path: str, name: str, value: Any) -> Callable[[Any], None]:
    return lambda stage: stage.GetPrimAtPath(f"/Studio/{path}").GetAttribute(name).Set(value)


def test_nothing_edited_nothing_lost(tmp_path: Path) -> None:
    assert_same_graph(studio(), edited(tmp_path, lambda stage: None))


def other_columns(graph: SceneGraph, name: str, row: str, kept: str) -> None:
    """All other values of that entity are exactly what they were."""
    before, after = studio()[row].component(name), graph[row].component(name)
    for key, values in before.items():
        if key not in kept.split():
            assert after[key].tolist() == values.tolist(), key


@pytest.mark.parametrize(
    ("name", "value", "key", "expected"),
    [
        ("focalLength", 0.85, "lens", 85.0),
        ("clippingRange", (0.5, 50.0), "clip_end clip_start", 50.0),
        ("horizontalAperture", 0.2, "sensor_width", 20.0),
        ("fStop", 4.0, "fstop focused focus_distance", 4.0),
    ],
)
def test_edited_cameras(tmp_path: Path, name: str, value: Any, key: str, expected: float) -> None:
    graph = edited(tmp_path, put("Eye/Eye", name, value))
    assert graph["Eye"].component("camera")[key.split()[0]][0] == pytest.approx(expected)
    other_columns(graph, "camera", "Eye", key)
    other_columns(graph, "camera", "Ortho", "")


@pytest.mark.parametrize(
    ("kind", "name", "value", "key", "expected"),
    [
        ("SUN", "intensity", 1.0, "energy", 4.0),
        ("POINT", "intensity", 10.0, "energy", 10 * np.pi),
        ("SPOT", "shaping:cone:angle", 30.0, "spot_size", np.pi / 3),
        ("POINT", "color", (1, 0, 0.5), "color", [1, 0, 0.5]),
        ("AREA", "width", 3.0, "size size_y shape", 3.0),
        ("SUN", "shadow:enable", True, "shadow", True),
    ],
)
def test_edited_lights(tmp_path: Path, kind: str, name: str, value: Any, key: str, expected: Any) -> None:
    graph = edited(tmp_path, put(f"{kind}/{kind}", f"inputs:{name}", value))
    assert graph[kind].component("light")[key.split()[0]][0] == pytest.approx(expected)
    other_columns(graph, "light", kind, key)


def test_hidden_and_shown_by_others(tmp_path: Path) -> None:
    def edit(stage: Any) -> None:
        stage.GetPrimAtPath("/Studio/Hidden").GetAttribute("visibility").Set("inherited")
        from pxr import UsdGeom

        UsdGeom.Imageable(stage.GetPrimAtPath("/Studio/Shown/Shown")).MakeInvisible()

    seen = edited(tmp_path, edit).components["visibility"]
    graph = studio()
    assert seen.rows.tolist() == [graph.row("Shown")]
    assert seen.columns["viewport"].all()


def test_moved_by_others(tmp_path: Path) -> None:
    from_usd = moved(5.0).T.tolist()

    def edit(stage: Any) -> None:
        from pxr import Gf, Vt

        stage.GetPrimAtPath("/Studio/Held").GetAttribute("xformOp:transform").Set(Gf.Matrix4d(from_usd))
        forest = next(prim for prim in stage.Traverse() if prim.GetTypeName() == "PointInstancer")
        forest.GetAttribute("positions").Set(Vt.Vec3fArray([(0, 0, float(z)) for z in range(12)]))

    graph = edited(tmp_path, edit)
    np.testing.assert_allclose(world_matrices(graph)[graph.row("Held")], moved(5.0))
    assert "world" not in graph.components
    assert graph["Forest"].component("instances")["matrix"][:, 2, 3].tolist() == list(range(12))


FOREIGN = """#usda 1.0
(
    upAxis = "Y"
    metersPerUnit = 0.01
)
def Camera "Eye" {
    float focalLength = 35
    float horizontalAperture = 36
    float verticalAperture = 24
    float focusDistance = 200
    float fStop = 2.8
}
def DistantLight "Sun" {
    float inputs:intensity = 2
}
def RectLight "Panel" {
    float inputs:width = 200
    float inputs:height = 50
    bool inputs:normalize = 1
    float inputs:intensity = 10
}
def DomeLight "Sky" {
}
"""


def test_cameras_and_lights_of_other_tools(tmp_path: Path) -> None:
    (tmp_path / "foreign.usda").write_text(FOREIGN)
    with pytest.warns(UserWarning, match="lights of this kind keep their place only: /Sky"):
        graph = read_usd(tmp_path / "foreign.usda")
    eye, sun, panel = (graph[name].component(kind) for name, kind in
                       (("Eye", "camera"), ("Sun", "light"), ("Panel", "light")))  # fmt: skip
    assert (eye["lens"][0], eye["sensor_width"][0], eye["focus_distance"][0]) == pytest.approx((35, 36, 2))
    assert (sun["kind"][0], sun["energy"][0]) == ("SUN", 8.0)
    assert (panel["kind"][0], panel["size"][0], panel["size_y"][0]) == ("AREA", 2.0, 0.5)
    assert panel["energy"][0] == pytest.approx(10 * np.pi)
