"""Rooms as MJCF: what stands in the file, that MuJoCo takes it, that our own reader finds the same again."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from tests.metrics.hand_made import Scene, at, box_mesh
from unisg_blender.errors import UniSGError
from unisg_blender.formats import read_scene_file, write_scene_file
from unisg_blender.scene import SceneGraph, table
from unisg_blender.scene.components import RIGID_BODIES
from unisg_blender.spatial.bodies import simulated_scene
from unisg_blender.worlds import living_room


def room() -> SceneGraph:
    scene = Scene()
    desk = scene.box("desk", (1, 1, 0.7), (0, 0, 0, 0.5), category="Table")
    scene.box("cup", (0.1, 0.1, 0.1), (0.2, 0, 0.7), parent=desk, category="Cup", relation=("on_top_of", "desk"))
    scene.box("bag", (0.1, 0.1, 0.1), (0.55, 0, 0.5), parent=desk, category="Bag", relation=("hangs_from", "desk"))
    long = at(1, 1, 0) @ np.diag([2, 1, -1, 1])
    scene.builder.add("long 'n thin", uid="long", mesh=box_mesh(((1, 0.2, 0.1), (0, 0, 0))), local=long)
    return scene.build()


def corners(graph: SceneGraph) -> dict[str, np.ndarray]:
    """Lowest and highest corner of all that hangs under each entity, by name."""
    found: dict[str, list[np.ndarray]] = {}
    for row in np.flatnonzero(graph.mesh >= 0):
        points = graph.meshes[graph.mesh[row]].points @ graph.world[row, :3, :3].T + graph.world[row, :3, 3]
        above = row
        while graph.category[above] < 0 and graph.parent[above] >= 0:
            above = graph.parent[above]
        found.setdefault(graph.name[above], []).append(points)
    return {name: np.array([np.concatenate(each).min(0), np.concatenate(each).max(0)]) for name, each in found.items()}


def test_things_move_the_building_does_not(tmp_path: Path) -> None:
    write_scene_file(room(), tmp_path / "room.xml")
    root = ElementTree.parse(tmp_path / "room.xml").getroot()
    bodies = {body.get("name"): body for body in root.iter("body")}
    assert {name for name, body in bodies.items() if body.find("freejoint") is not None} == {
        "desk",
        "cup",
        "long 'n thin",
    }
    assert [child.get("name") for child in bodies["desk"].iterfind("body")] == ["bag"]
    assert [child.get("name") for child in root.find("worldbody")] == ["cup", "desk", "floor", "long 'n thin"]
    seen, piece = bodies["cup"].findall("geom")
    assert (seen.get("contype"), seen.get("mass"), piece.get("contype"), piece.get("group")) == ("0", "0", None, "3")
    assert (tmp_path / "room.assets" / "0001.obj").is_file()


def test_our_reader_finds_the_same_again(tmp_path: Path) -> None:
    graph = room()
    assert list(write_scene_file(graph, tmp_path / "room.xml")) == ["relations are not written to MJCF"]
    again = read_scene_file(tmp_path / "room.xml")[0]
    expected, found = corners(graph), corners(again)
    assert found.keys() == expected.keys()
    for name, ends in expected.items():
        np.testing.assert_allclose(found[name], ends, atol=1e-6, err_msg=name)
    kinds = {again.name[row]: again.category_name(row) for row in range(len(again)) if again.category[row] >= 0}
    assert kinds == {"floor": "Floor", "desk": "Table", "cup": "Cup", "bag": "Bag"}


def test_boxes_are_boxes_and_masses_those_that_are_said(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo, the extra 'judge', is not installed")
    graph = simulated_scene(room(), "box")
    bodies = graph.components[RIGID_BODIES]
    mass = np.where(bodies.rows == graph.row_of_uid["cup"], 3.0, bodies.columns["mass"])
    heavy = graph.with_component(RIGID_BODIES, table(bodies.rows, **{**bodies.columns, "mass": mass}))
    write_scene_file(heavy, tmp_path / "room.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "room.xml"))
    assert model.body("cup").mass[0] == pytest.approx(3.0)
    assert model.body("desk").mass[0] == pytest.approx(250 * 0.7)
    assert (model.geom_type == mujoco.mjtGeom.mjGEOM_BOX).sum() == 4


@pytest.mark.filterwarnings("error")
def test_the_simulator_takes_a_whole_room_and_nothing_falls(tmp_path: Path, capfd) -> None:
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo, the extra 'judge', is not installed")
    write_scene_file(living_room(3), tmp_path / "home.mjcf")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "home.mjcf"))
    data = mujoco.MjData(model)
    before = data.qpos.reshape(-1, 7).copy()
    for _ in range(200):
        mujoco.mj_step(model, data)
    assert np.abs(data.qpos.reshape(-1, 7) - before)[:, :3].max() < 0.01
    assert capfd.readouterr() == ("", "")


def test_nothing_is_left_of_a_file_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "room.assets").write_text("mine", "utf-8")
    with pytest.raises(UniSGError):
        write_scene_file(room(), tmp_path / "room.xml")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["room.assets"]
