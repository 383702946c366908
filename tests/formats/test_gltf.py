"""A scene as glTF is the scene: read back to the last bit, and shown by other readers as it is."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings

from tests.formats.test_json_scenes import assert_identical
from tests.interactivity.graph_rules import broken_rules
from tests.usd.random_scenes import scenes
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.formats.gltf.gltf_axes import placements
from unisg_blender.formats.gltf.gltf_container import packed, unpacked
from unisg_blender.formats.gltf.gltf_files import VIEW, read_own_gltf, write_gltf
from unisg_blender.formats.json_scenes import KEY
from unisg_blender.formats.scene_files import opened_by_blender, read_all_scenes, read_scene_file, write_scene_file
from unisg_blender.geometry.y_up import turned_matrices, turned_points
from unisg_blender.scene import Material, Mesh, SceneBuilder, SceneGraph, mesh_from_faces, table
from unisg_blender.scene.properties import ACTIONS, LSA, decode_properties
from unisg_blender.worlds import WORLDS, operating_room

SQUARE = mesh_from_faces("Square", np.array([[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0]]), [[0, 1, 2, 3]])


def through_file(graph: SceneGraph, ending: str = "glb") -> SceneGraph:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"scene.{ending}")
        write_gltf(graph, path)
        found = read_own_gltf(path)
    assert found is not None
    return found


def document_of(graph: SceneGraph, folder: Path, **options: Any) -> dict[str, Any]:
    write_gltf(graph, folder / "scene.glb", **options)
    return unpacked((folder / "scene.glb").read_bytes(), "it")[0]


@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10_000), ending=st.sampled_from(["glb", "gltf"]))
def test_operating_rooms_come_back_to_the_last_bit(seed: int, ending: str) -> None:
    graph = operating_room(seed)
    assert_identical(graph, through_file(graph, ending))


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(scenes(), st.sampled_from(["glb", "gltf"]))
def test_hard_scenes_come_back_to_the_last_bit(graph: SceneGraph, ending: str) -> None:
    assert_identical(graph, through_file(graph, ending))


@pytest.mark.parametrize("ending", ["glb", "gltf"])
def test_verbs_and_both_readers_read_it_without_blender(ending: str, tmp_path: Path) -> None:
    graph = WORLDS["living-room"](2)
    path = tmp_path / f"room.{ending}"
    write_scene_file(graph, path)
    assert_identical(graph, read_scene_file(path)[0])
    assert_identical(graph, next(iter(read_all_scenes(path).graphs)))
    assert not opened_by_blender(path)
    assert main(["convert", str(path), str(tmp_path / "again.json"), "-q"]) == 0
    assert_identical(graph, read_scene_file(tmp_path / "again.json")[0])


def test_others_see_every_mesh_where_it_is(tmp_path: Path) -> None:
    graph = operating_room(4)
    write_gltf(graph, tmp_path / "room.glb")
    seen = trimesh.load(tmp_path / "room.glb")
    low, high = np.array([[np.inf] * 3, [-np.inf] * 3])
    for row in np.flatnonzero(graph.mesh >= 0):
        world, points = graph.world[row], graph.meshes[graph.mesh[row]].points
        placed = turned_points(points @ world[:3, :3].T + world[:3, 3])
        low, high = np.minimum(low, placed.min(axis=0)), np.maximum(high, placed.max(axis=0))
    np.testing.assert_allclose(seen.bounds, [low, high], atol=1e-5)
    area = sum(
        trimesh.Trimesh(mesh.points @ world[:3, :3].T, mesh.triangles, process=False).area
        for row, world in enumerate(graph.world)
        if graph.mesh[row] >= 0
        for mesh in [graph.meshes[graph.mesh[row]]]
    )
    assert seen.to_geometry().area == pytest.approx(area, rel=1e-4)


def test_nodes_are_entities_with_their_properties(tmp_path: Path) -> None:
    graph = operating_room(1)
    nodes = document_of(graph, tmp_path)["nodes"]
    for row, node in enumerate(nodes[: len(graph)]):
        said = decode_properties(node["extras"])
        assert (node["name"], said.uid, said.category) == (graph.name[row], graph.uid[row], graph.category_name(row))
        assert said.actions == graph[row].actions
        assert node.get("children", []) == [child.row for child in graph[row].children]
    lessons = [node["extras"][LSA] for node in nodes if LSA in node.get("extras", {})]
    assert len(lessons) == len(graph.entries("lsa"))
    assert any(ACTIONS in node.get("extras", {}) for node in nodes)


@given(st.integers(0, 2**32 - 1))
def test_parts_of_a_place_are_the_place(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]  # mirrors too
    matrix = np.eye(4)
    matrix[:3] = np.c_[turn * rng.uniform(0.1, 3, 3), rng.normal(size=3)]
    (place,) = placements(matrix[None])
    assert "matrix" not in place
    x, y, z, w = place.get("rotation", [0, 0, 0, 1])
    rotation = trimesh.transformations.quaternion_matrix([w, x, y, z])[:3, :3]
    np.testing.assert_allclose(rotation * place.get("scale", [1, 1, 1]), matrix[:3, :3], atol=1e-8)
    np.testing.assert_allclose(place.get("translation", [0, 0, 0]), matrix[:3, 3])


def test_shear_stays_a_matrix_and_turning_is_exact() -> None:
    matrix = np.eye(4)
    matrix[0, 1], matrix[2, 3] = 0.5, 3.0
    (place,) = placements(turned_matrices(matrix[None]))
    found = np.reshape(place["matrix"], (4, 4)).T
    point = np.array([1.0, 2.0, 3.0])
    moved = matrix[:3, :3] @ point + matrix[:3, 3]
    np.testing.assert_array_equal(found[:3, :3] @ [1, 3, -2] + found[:3, 3], moved[[0, 2, 1]] * [1, 1, -1])


def test_lessons_are_behaviour_graphs_and_what_cannot_be_played_is_told(tmp_path: Path) -> None:
    graph = operating_room(1)
    document = document_of(graph, tmp_path)
    (found,) = document["extensions"]["KHR_interactivity"]["graphs"]
    assert "KHR_interactivity" in document["extensionsUsed"]
    assert found["name"] == graph.entries("lsa", "data")[0][1].name
    assert broken_rules({key: part for key, part in found.items() if key != "name"}, len(document["nodes"])) == []
    report = write_gltf(graph.replace(components={"lsa": graph.components["lsa"]}), tmp_path / "broken.glb")
    assert "not in the scene" in report.summary()
    assert "extensions" not in unpacked((tmp_path / "broken.glb").read_bytes(), "it")[0]


def test_materials_by_slot_and_own_ones(tmp_path: Path) -> None:
    two = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0], [2, 1, 0], [3, 1, 0]])
    mesh = mesh_from_faces("Two", two, [[0, 1, 2], [3, 4, 5]])
    mesh = Mesh(mesh.name, mesh.points, mesh.corners, mesh.offsets, material_index=np.array([0, 1], np.int32),
                materials=("Red", "Glass"))  # fmt: skip
    builder = SceneBuilder("Panes")
    builder.add("First", uid="a", mesh=mesh)
    builder.add("Second", uid="b", mesh=mesh)
    materials = {
        "Red": Material("Red", (1, 0, 0, 1)), "Glass": Material("Glass", (1, 1, 1, 0.2)), "Blue": Material("Blue"),
    }  # fmt: skip
    graph = builder.build().replace(materials=materials)
    graph = graph.with_component("materials", table([1], slot=np.array([1], np.int32), material=["Blue"]))
    document = document_of(graph, tmp_path)
    names = [each["name"] for each in document["materials"]]
    used = [
        [names[part["material"]] for part in document["meshes"][node["mesh"]]["primitives"]]
        for node in document["nodes"]
    ]
    assert used == [["Red", "Glass"], ["Red", "Blue"]]
    assert document["materials"][names.index("Glass")]["alphaMode"] == "BLEND"
    shapes = [[part["attributes"] for part in mesh["primitives"]] for mesh in document["meshes"]]
    assert shapes[0] == shapes[1]  # the points are in the file once


def test_instances_are_nodes_for_others_and_instances_for_us(tmp_path: Path) -> None:
    inner = SceneBuilder("Inner")
    inner.add("Tile", uid="t", mesh=SQUARE)
    outer = SceneBuilder("Outer")
    outer.add("Floor", uid="f")
    places = np.stack([np.eye(4)] * 3)
    places[:, 0, 3] = [0, 1, 2]
    prototype = inner.build()
    graph = outer.build().with_component(
        "instances", table([0, 0, 0], prototype=[prototype] * 3, matrix=places, source=["COLLECTION"] * 3)
    )
    document = document_of(graph, tmp_path)
    assert [node["name"] for node in document["nodes"]].count("Tile") == 3
    assert len(document["meshes"]) == 1
    assert_identical(graph, through_file(graph))


def test_a_viewer_gets_no_more_than_the_view(tmp_path: Path) -> None:
    graph = operating_room(2)
    document = document_of(graph, tmp_path, whole=False)
    assert "extras" not in document
    assert read_own_gltf(tmp_path / "scene.glb") is None
    referred = {accessor["bufferView"] for accessor in document["accessors"]}
    assert referred == set(range(len(document["bufferViews"])))


def test_what_was_changed_since_is_no_longer_our_scene(tmp_path: Path) -> None:
    path = tmp_path / "scene.gltf"
    write_gltf(operating_room(2), path)
    document = json.loads(path.read_text())
    document["nodes"][1]["name"] = "Renamed"
    path.write_text(json.dumps(document))
    assert read_own_gltf(path) is None
    assert opened_by_blender(path)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda record: record.update(unisg_scene=99), "update it"),
        (lambda record: record["entities"][0].pop("uid"), "damaged"),
        (lambda record: record["meshes"][0]["points"].update(view=10**6), "damaged"),
        (lambda record: record["meshes"][0]["points"].update(dtype="O"), "damaged"),
        (lambda record: record["meshes"][0].update(points=[[0, 0]]), "damaged"),
        (lambda record: record.pop("meshes"), "damaged"),
    ],
)
def test_damage_is_one_line(tmp_path: Path, change: Any, reason: str) -> None:
    path = tmp_path / "scene.glb"
    write_gltf(WORLDS["cubes"](0), path)
    document, data = unpacked(path.read_bytes(), "it")
    view = document["bufferViews"][document["extras"][KEY]]
    record = json.loads(data[view["byteOffset"] :][: view["byteLength"]])
    change(record)
    text = json.dumps(record).encode()
    view |= {"byteOffset": len(data), "byteLength": len(text)}
    path.write_bytes(packed(document, data + text, True))
    with pytest.raises(UniSGError, match=reason) as told:
        read_scene_file(path)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("place", [-1, 10**9, "points", None])
def test_a_record_that_is_not_there_is_one_line(tmp_path: Path, place: Any) -> None:
    path = tmp_path / "scene.glb"
    write_gltf(WORLDS["cubes"](0), path)
    document, data = unpacked(path.read_bytes(), "it")
    document["extras"][KEY] = place
    if place == -1:
        document["bufferViews"][-1]["byteLength"] //= 2
    path.write_bytes(packed(document, data, True))
    with pytest.raises(UniSGError, match="damaged"):
        read_scene_file(path)


@pytest.mark.parametrize(
    "content", [b"", b"glTF", b"glTF" + b"\xff" * 30, VIEW.encode(), b'{"extras": {"unisg_view": 1}}']
)
def test_other_bytes_are_not_ours(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "scene.glb"
    path.write_bytes(content)
    assert read_own_gltf(path) is None


@given(st.binary(max_size=9))
def test_both_forms_hold_document_and_bytes(data: bytes) -> None:
    for binary in (True, False):
        document, found = unpacked(packed({"asset": {"version": "2.0"}}, data, binary), "it")
        assert document["asset"] == {"version": "2.0"}
        assert found[: len(data)] == data


def test_what_has_no_number_is_told_and_shown_nearby(tmp_path: Path) -> None:
    local = np.eye(4)
    local[0, 3] = np.nan
    builder = SceneBuilder("Odd")
    builder.add('say "hi" <script>', uid="o", mesh=SQUARE)
    graph = builder.build().replace(local=local[None])
    report = write_gltf(graph, tmp_path / "odd.glb")
    assert "no number" in report.summary()
    assert trimesh.load(tmp_path / "odd.glb").bounds is not None


@pytest.mark.slow
def test_blender_imports_the_view_with_uids_categories_and_actions(tmp_path: Path) -> None:
    pytest.importorskip("bpy")
    graph = operating_room(5)
    write_gltf(graph, tmp_path / "room.glb", whole=False)
    found, _ = read_scene_file(tmp_path / "room.glb")
    rows = [found.row_of_uid[uid] for uid in graph.uid]
    np.testing.assert_allclose(found.world[rows], graph.world, atol=1e-5)
    assert [found.category_name(row) for row in rows] == [graph.category_name(row) for row in range(len(graph))]
    assert [found[row].actions for row in rows] == [graph[row].actions for row in range(len(graph))]
    assert [tree for _, tree in found.entries("lsa", "data")] == [tree for _, tree in graph.entries("lsa", "data")]
