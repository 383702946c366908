"""Worlds and robots of simulators: frames, turns, units and shapes with known answers; what is damaged or hostile."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.formats.reading import bounds, found_in, write
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.formats.scene_files import read_scene_file
from unisg_blender.formats.simulators.shapes import shape

BOX = "<geometry><box><size>2 1 0.5</size></box></geometry>"
WORLD = f"""<?xml version="1.0"?><sdf version="1.6"><world name="w">
<model name="table"><static>true</static><pose>1 2 0.25 0 0 1.5707963267948966</pose>
  <link name="l"><pose>0 0 1 0 0 0</pose>
  <visual name="top"><pose degrees="true">0 0 0 0 90 0</pose>{BOX}</visual></link>
</model>
<include><uri>model://chair</uri><name>seat</name><pose>5 0 0 0 0 0</pose></include>
<include><uri>model://lost</uri></include>
<include><uri>model://ground_plane</uri><pose>0 0 0.5 0 0 0</pose></include>
<model name="mesh"><link name="l"><visual name="v"><geometry><mesh><uri>model://chair/meshes/wedge.dae</uri>
  <scale>2 2 2</scale></mesh></geometry></visual></link></model>
</world></sdf>"""
CHAIR = """<sdf version="1.6"><model name="chair"><pose>9 9 9 0 0 0</pose><link name="l"><visual name="v"><geometry>
<cylinder><radius>0.5</radius><length>2</length></cylinder></geometry></visual></link></model></sdf>"""
DAE = """<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01" name="centimeter"/><up_axis>{up}</up_axis></asset>
<library_geometries><geometry id="same" name="wedge"><mesh>
 <source id="p"><float_array id="f" count="12">0 0 0 100 0 0 0 200 0 0 0 300</float_array><technique_common>
  <accessor source="#f" count="4" stride="3"/></technique_common></source>
 <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
 <polylist count="4"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#p" offset="1"/>
  <vcount>3 3 3 3</vcount><p>0 0 2 0 1 0 0 0 1 0 3 0 0 0 3 0 2 0 1 0 2 0 3 0</p></polylist></mesh></geometry>
</library_geometries>
<library_visual_scenes><visual_scene id="same"><node id="n" name="part"><translate>100 0 0</translate>
 <rotate>0 0 1 90</rotate><instance_geometry url="#same"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#same"/></scene></COLLADA>"""


@pytest.fixture
def world(tmp_path: Path) -> Path:
    write(tmp_path / "models" / "chair" / "model.sdf", CHAIR)
    write(tmp_path / "models" / "chair" / "meshes" / "wedge.dae", DAE.format(up="Y_UP"))
    return write(tmp_path / "worlds" / "room.world", WORLD)


def test_a_world_of_gazebo_is_read_as_it_stands(world: Path) -> None:
    (found,) = found_in(world)
    graph = found.graph
    # two metres long along x, tipped by a quarter about y: two metres high; then turned by a quarter about z
    np.testing.assert_allclose(bounds(graph, "top"), [[0.5, 1.75, 0.25], [1.5, 2.25, 2.25]], atol=1e-6)
    np.testing.assert_allclose(bounds(graph, "v"), [[4.5, -0.5, -1], [5.5, 0.5, 1]], atol=1e-6)
    assert graph["seat"].children[0].name == "v"
    # centimetres, scaled by two; its axis up is not asked
    np.testing.assert_allclose(bounds(graph, "part"), [[-2, 0, 0], [2, 2, 6]], atol=1e-5)
    np.testing.assert_allclose(bounds(graph, "ground_plane"), [[-50, -50, 0.5], [50, 50, 0.5]])  # Gazebo's own
    assert "model://lost: this model is not there: it is left out" in list(found.report)


@pytest.mark.parametrize(
    ("up", "corners"),
    [
        ("Z_UP", [[-1, 0, 0], [1, 1, 3]]),
        ("Y_UP", [[-1, -3, 0], [1, 0, 1]]),
        ("X_UP", [[-3, 0, -1], [0, 1, 1]]),
    ],
)
def test_a_collada_file_stands_upright_in_metres(tmp_path: Path, up: str, corners: list[list[float]]) -> None:
    graph, lost = read_scene_file(write(tmp_path / "a.dae", DAE.format(up=up)))
    np.testing.assert_allclose(bounds(graph, "part"), corners, atol=1e-6)
    assert list(lost) == ["materials, textures and motion are not read"]


URDF = """<robot name="r">
<link name="arm"><visual><origin xyz="0 0 1" rpy="0 0 0"/><geometry><box size="0.2 0.2 2"/></geometry></visual></link>
<link name="base"><visual name="foot"><geometry><sphere radius="1"/></geometry></visual></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
<origin xyz="0 0 1" rpy="0 1.5707963267948966 0"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="2"/></joint></robot>"""


def test_links_of_urdf_hang_from_their_joints(tmp_path: Path) -> None:
    (found,) = found_in(write(tmp_path / "a.urdf", URDF))
    graph = found.graph
    np.testing.assert_allclose(bounds(graph, "visual"), [[0, -0.1, 0.9], [2, 0.1, 1.1]], atol=1e-6)
    assert graph["arm"].parent.name == "base"
    ((row, name, kind, axis, low, high),) = graph.entries("joints", "name", "kind", "axis", "low", "high")
    assert (graph.name[row], name, kind, low, high) == ("arm", "turn", "revolute", -1, 2)
    np.testing.assert_array_equal(axis, [0, 1, 0])


MJCF = """<mujoco><compiler angle="degree"/><default><default class="v"><geom contype="0" conaffinity="0"/></default>
</default><worldbody><geom name="ground" type="plane" size="3 2 0.1"/>
<body name="door" pos="1 0 0" euler="0 0 90"><joint name="hinge" range="0 90"/><include file="leaf.xml"/>
<geom name="hull" type="box" size="9 9 9"/></body>
<body name="rod"><geom name="stick" type="capsule" fromto="0 0 0 2 0 0" size="0.1"/></body></worldbody></mujoco>"""
LEAF = '<mujocoinclude><geom name="leaf" class="v" type="box" size="0.5 0.1 1" pos="0.5 0 1"/></mujocoinclude>'


def test_bodies_of_mjcf_show_what_is_seen(tmp_path: Path) -> None:
    write(tmp_path / "leaf.xml", LEAF)
    write(tmp_path / "room_metadata.json", {"objects": {"door": {"category": "Door"}}})
    (found,) = found_in(write(tmp_path / "room.xml", MJCF))
    graph = found.graph
    np.testing.assert_allclose(bounds(graph, "leaf"), [[0.9, 0, 0], [1.1, 1, 2]], atol=1e-6)
    np.testing.assert_allclose(bounds(graph, "stick"), [[-0.1, -0.1, -0.1], [2.1, 0.1, 0.1]], atol=2e-3)
    np.testing.assert_allclose(bounds(graph, "ground"), [[-3, -2, 0], [3, 2, 0]], atol=1e-6)
    assert "hull" not in graph.name
    assert graph["door"].category == "Door"
    ((_, kind, high),) = graph.entries("joints", "kind", "high")
    assert (kind, high) == ("revolute", pytest.approx(np.pi / 2))


@pytest.mark.parametrize(("kind", "size", "half"), [
    ("box", (1, 2, 3), (0.5, 1, 1.5)), ("sphere", (2,), (2, 2, 2)), ("ellipsoid", (1, 2, 3), (1, 2, 3)),
    ("cylinder", (1, 4), (1, 1, 2)), ("capsule", (1, 4), (1, 1, 3)), ("plane", (4, 2), (2, 1, 0)),
])  # fmt: skip
def test_shapes_are_as_large_as_told_and_face_outwards(
    kind: str, size: tuple[float, ...], half: tuple[float, ...]
) -> None:
    mesh = shape(kind, *size)
    np.testing.assert_allclose(mesh.bounds, [np.negative(half), half], atol=1e-6)
    corners = mesh.points[mesh.triangles].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", normals, corners.mean(axis=1)) < -1e-9
    assert not inward.any()


BOMB = '<!DOCTYPE b [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]><sdf>&b;</sdf>'
HOSTILE = {
    "entities.world": BOMB,
    "outside.sdf": '<!DOCTYPE b [<!ENTITY a SYSTEM "file:///etc/passwd">]><sdf>&a;</sdf>',
    "deep.world": "<sdf>" + "<model>" * 5000 + "</model>" * 5000 + "</sdf>",
    "cut.world": WORLD[:300],
    "words.world": WORLD.replace("1 2 0.25 0 0 1.57", "one two"),
    "size.world": WORLD.replace("<size>2 1 0.5", "<size>2 -1 0.5"),
    "circle.urdf": URDF.replace('<child link="arm"/>', "<child link=\"base\"/>"),
    "gone.urdf": URDF.replace('<parent link="base"/>', '<parent link="nobody"/>'),
    "self.xml": '<mujoco><include file="self.xml"/></mujoco>',
    "size.xml": MJCF.replace('size="0.1"', 'size=""'),
    "other.xml": "<html><body/></html>",
    "unit.dae": DAE.format(up="Z_UP").replace('meter="0.01"', 'meter="nan"'),
    "faces.dae": DAE.format(up="Z_UP").replace("<p>0 0 2", "<p>0 0 77"),
    "count.dae": DAE.format(up="Z_UP").replace("3 3 3 3<", "3 3 3 9<"),
    "nodes.dae": DAE.format(up="Z_UP").replace('<instance_geometry url="#same"/>', '<instance_node url="#n"/>'),
    "empty.dae": "<COLLADA/>",
    "text.ply": "no mesh",
    "text.stl": "no mesh",
    "text.off": "OFF\n3 1 0\n",
    "text.3mf": "no package",
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_hostile_is_one_line(tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path / name, HOSTILE[name])
    assert main(["inspect", str(path)]) == 1
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1
    assert str(path) in told[0]


def test_models_within_each_other_end(tmp_path: Path) -> None:
    write(
        tmp_path / "models" / "a" / "model.sdf",
        '<sdf><model name="a"><include><uri>model://a</uri></include></model></sdf>',
    )
    path = write(tmp_path / "a.world", "<sdf><world><include><uri>model://a</uri></include></world></sdf>")
    with pytest.raises(UniSGError, match="deep"):
        found_in(path)


@pytest.mark.parametrize("ending", [".ply", ".stl", ".off"])
def test_meshes_without_a_unit_are_taken_in_metres(tmp_path: Path, ending: str) -> None:
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box((1, 2, 3)).export(tmp_path / f"box{ending}")
    graph, lost = read_scene_file(tmp_path / f"box{ending}")
    mesh = graph.meshes[0]
    np.testing.assert_allclose(mesh.bounds, [[-0.5, -1, -1.5], [0.5, 1, 1.5]], atol=1e-6)
    assert len(mesh.points) == 8
    assert any("no unit" in line for line in lost)


def test_a_3mf_is_in_the_unit_that_it_names(tmp_path: Path) -> None:
    import zipfile

    points = "".join(
        f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in ((0, 0, 0), (10, 0, 0), (0, 20, 0), (0, 0, 30))
    )
    model = f"""<model unit="centimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>
<object id="1" name="peg"><mesh><vertices>{points}</vertices><triangles>
<triangle v1="0" v2="2" v3="1"/></triangles></mesh>
</object><object id="2"><components><component objectid="1" transform="0 1 0 -1 0 0 0 0 1 0 0 5"/></components></object>
</resources><build><item objectid="2" transform="1 0 0 0 1 0 0 0 1 100 0 0"/></build></model>"""
    with zipfile.ZipFile(tmp_path / "a.3mf", "w") as package:
        package.writestr("3D/3dmodel.model", model)
    graph, _ = read_scene_file(tmp_path / "a.3mf")
    np.testing.assert_allclose(bounds(graph, "peg"), [[0.8, 0, 0.05], [1, 0.1, 0.35]], atol=1e-6)
