"""Meshes, materials, custom properties and the other components, from Blender and back."""

from __future__ import annotations

import json

import bpy
import numpy as np
import pytest

from tests.blender.helpers import add, assert_same_scene, box
from unisg_blender import UniSGError
from unisg_blender.blender import ReadReport, read_scene, write_rows, write_scene
from unisg_blender.scene import ActionData, LessonNode, Mesh, Relation, SceneBuilder, mesh_from_faces
from unisg_blender.scene.mesh import check_mesh
from unisg_blender.scene.properties import relations_of


def sphere() -> bpy.types.Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=8, ring_count=6)
    return bpy.context.object


def test_a_shared_mesh_is_stored_once_and_stays_shared() -> None:
    mesh = box()
    for number in range(3):
        add(f"Box {number}", mesh)
    add("Other", box("Other"))
    graph = read_scene()
    assert len(graph.meshes) == 2
    written = write_scene(graph)
    assert len({item.data for item in written.objects}) == 2


def test_evaluated_and_original_meshes() -> None:
    mesh = box()
    plain, first, second = add("A", mesh), add("B", mesh), add("C", mesh)
    for item in (first, second):
        item.modifiers.new("Subdivide", "SUBSURF").levels = 1
    evaluated, original = read_scene(), read_scene(geometry="original")
    assert len(original.meshes) == 1
    assert sorted(len(mesh.points) for mesh in evaluated.meshes) == [8, 26]
    assert evaluated.mesh[evaluated.row("B")] == evaluated.mesh[evaluated.row("C")]
    assert (read_scene(geometry="none").mesh == -1).all()
    assert len(plain.data.vertices) == 8


@pytest.mark.parametrize("shading", ["flat", "smooth", "sharp edges", "custom"])
def test_corner_normals(shading: str) -> None:
    mesh = sphere().data
    if shading != "flat":
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if shading == "sharp edges":
        mesh.attributes.new("sharp_edge", "BOOLEAN", "EDGE")
        mesh.attributes["sharp_edge"].data.foreach_set("value", [edge % 3 == 0 for edge in range(len(mesh.edges))])
    if shading == "custom":
        mesh.normals_split_custom_set([(0, 0.6, 0.8)] * len(mesh.loops))
    mesh.update()
    graph = read_scene()
    expected = np.array([normal.vector for normal in mesh.corner_normals])
    if shading == "flat":
        assert graph.meshes[0].normals is None
    else:
        np.testing.assert_allclose(graph.meshes[0].normals, expected, atol=1e-6)
    written = write_scene(graph).objects[0].data
    found = np.array([normal.vector for normal in written.corner_normals])
    np.testing.assert_allclose(found, expected, atol=1e-5 if bpy.app.version >= (4, 5) else 2e-3)


def test_uvs_materials_and_loose_edges() -> None:
    mesh = sphere().data
    mesh.uv_layers.new(name="Second")
    red, blue = bpy.data.materials.new("Red"), bpy.data.materials.new("Blue")
    red.use_nodes = True
    red.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.8, 0.1, 0.05, 1)
    red.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.25
    mesh.materials.append(red)
    mesh.materials.append(blue)
    mesh.polygons[3].material_index = 1
    wire = bpy.data.meshes.new("Wire")
    wire.from_pydata([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1), (1, 2)], [])
    own = add("Own material", box())
    own.data.materials.append(red)
    own.material_slots[0].link, own.material_slots[0].material = "OBJECT", blue
    add("Wire", wire)
    graph = read_scene()
    ball = graph["Sphere"].mesh
    assert list(ball.uvs) == ["UVMap", "Second"]
    assert ball.materials == ("Red", "Blue")
    assert np.flatnonzero(ball.material_index).tolist() == [3]
    assert graph.materials["Red"].base_color == pytest.approx((0.8, 0.1, 0.05, 1))
    assert graph.materials["Red"].roughness == pytest.approx(0.25)
    assert graph["Wire"].mesh.edges.tolist() == [[0, 1], [1, 2]]
    assert graph["Own material"].component("materials")["material"].tolist() == ["Blue"]
    assert_same_scene(graph, read_scene(write_scene(graph)))


def test_behaviour_and_other_custom_properties() -> None:
    builder = SceneBuilder()
    lesson = LessonNode("operation", "o", children=(LessonNode("lesson", "l"),))
    table = builder.add("Table", uid="table", category="Table", lsa=lesson)
    builder.add(
        "Scalpel", uid="scalpel", parent=table, category="Scalpel", relations=(Relation("on_top_of", "table"),),
        actions=(ActionData("take", "Remove", targets=("scalpel",)), ActionData("cut", "Use", tools=("scalpel",))),
    )  # fmt: skip
    graph = builder.build()
    again = read_scene(write_scene(graph))
    assert (again.uid, again.vocabulary) == (graph.uid, ("Scalpel", "Table"))
    assert again["Scalpel"].actions == graph["Scalpel"].actions
    assert relations_of(again, again.row("Scalpel")) == (Relation("on_top_of", "table"),)
    assert again.components["lsa"].columns["data"][0] == lesson


def test_values_of_other_tools_come_through() -> None:
    item = add("Thing", box())
    values = {"weight": 2.5, "count": 7, "tags": [1, 2, 3], "nested": {"a": {"b": "text"}}, "flag": True, "name": "ü"}
    for key, value in values.items():
        item[key] = value
    item["points at"] = add("Other")
    graph = read_scene()
    found = json.loads(graph["Thing"].component("properties")["json"][0])
    assert found == values | {"points at": {"id": "OBJECT", "name": "Other"}}
    again = read_scene(write_scene(graph))
    assert json.loads(again["Thing.001"].component("properties")["json"][0]) == found


def test_a_bad_property_spoils_nothing() -> None:
    item = add("Thing", box())
    item["unisg_actions"], item["unisg_category"] = "{not json", 5
    report = ReadReport()
    graph = read_scene(report=report)
    assert graph["Thing"].category == ""
    assert any("unisg_actions" in line for line in report)
    assert any("unisg_category" in line for line in report)


def test_every_object_type_is_an_entity_and_comes_back() -> None:
    data = bpy.data
    made = {
        "MESH": box(), "EMPTY": None, "CAMERA": data.cameras.new("x"), "LIGHT": data.lights.new("x", "AREA"),
        "ARMATURE": data.armatures.new("x"), "CURVE": data.curves.new("x", "CURVE"),
        "FONT": data.curves.new("t", "FONT"),
        "SURFACE": data.curves.new("x", "SURFACE"), "META": data.metaballs.new("x"), "LATTICE": data.lattices.new("x"),
        "CURVES": data.hair_curves.new("x"), "POINTCLOUD": data.pointclouds.new("x"), "VOLUME": data.volumes.new("x"),
        "SPEAKER": data.speakers.new("x"), "LIGHT_PROBE": data.lightprobes.new("x", "SPHERE"),
    }  # fmt: skip
    made["FONT"].body = "UniSG"
    for kind, block in made.items():
        add(kind.title(), block)
    graph = read_scene()
    assert {graph[row].type for row in range(len(graph))} == set(made)
    again = read_scene(write_scene(graph))
    assert sorted(again.type.tolist()) == sorted(graph.type.tolist())
    assert again["Font.001"].type == "FONT"
    assert len(again["Font.001"].mesh.points) == len(graph["Font"].mesh.points) > 0


def test_rows_added_to_a_standing_scene_share_its_meshes() -> None:
    tray = add("Tray", box("Tray"))
    tray["unisg_uid"] = "tray"
    graph = read_scene()
    builder = SceneBuilder()
    above = builder.add("Tray", uid="tray", mesh=graph.meshes[0])
    builder.add("Second tray", uid="second", parent=above, mesh=graph.meshes[0], category="Tray")
    wanted = builder.build()
    made = write_rows(wanted, [wanted.row("Second tray")], bpy.context.scene)
    assert [item.name for item in made] == ["Second tray"]
    assert made[0].parent == tray
    assert made[0].data == tray.data
    assert len(bpy.context.scene.objects) == 2
    assert_same_scene(wanted, read_scene())


@pytest.mark.parametrize(
    "damage",
    [
        {"corners": [0, 1, 3]}, {"corners": [-1, 1, 2]}, {"offsets": [0, 4]}, {"offsets": [1, 3]},
        {"offsets": [0, 4, 3]}, {"offsets": []}, {"edges": [[0, 3]]}, {"edges": [[-1, 0]]}, {"material_index": [0, 0]},
    ],
)  # fmt: skip
def test_a_damaged_mesh_changes_nothing(damage: dict[str, list[int]]) -> None:
    points = np.zeros((3, 3), np.float32)
    sound = {"corners": [0, 1, 2], "offsets": [0, 3]}
    bad = Mesh("Bad", points, **{name: np.array(values, np.int32) for name, values in (sound | damage).items()})
    builder = SceneBuilder()
    builder.add("Good", uid="g", mesh=mesh_from_faces("Good", points, [[0, 1, 2]]))
    builder.add("Bad", uid="b", mesh=bad)
    with pytest.raises(UniSGError, match="'Bad' is damaged"):
        write_scene(builder.build())
    assert not bpy.data.objects
    assert not bpy.data.meshes
    assert len(bpy.data.scenes) == 1


def test_strange_meshes_do_no_harm() -> None:
    builder = SceneBuilder()
    nothing = Mesh("Nothing", np.zeros((0, 3), np.float32), np.zeros(0, np.int32), np.zeros(1, np.int32))
    builder.add("Nothing", uid="0", mesh=nothing)
    points = np.array([[0, 0, 0], [1, 0, 0], [np.nan, np.inf, 0]], np.float32)
    builder.add("Not a number", uid="1", mesh=mesh_from_faces("Nan", points, [[0, 1, 2]]))
    builder.add("Twice the same corner", uid="2", mesh=mesh_from_faces("Twice", np.eye(3), [[0, 0, 1], [0, 1, 2]]))
    builder.add("日本語 / \"quotes\" \\ 'x'" * 10, uid="3")
    again = read_scene(write_scene(builder.build()))
    assert len(again) == 4
    assert all(np.isfinite(mesh.points).all() for mesh in again.meshes)


def test_points_that_are_no_numbers_are_told() -> None:
    mesh = bpy.data.meshes.new("Odd")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (float("nan"), 1, 0)], [], [(0, 1, 2)])
    bpy.context.collection.objects.link(bpy.data.objects.new("Odd", mesh))
    report = ReadReport()
    read_scene(report=report)
    assert "Odd: some of its points are not finite numbers" in list(report)


def test_an_empty_scene() -> None:
    graph = read_scene()
    assert len(graph) == 0
    assert len(read_scene(write_scene(graph))) == 0


@pytest.mark.parametrize(("materials", "expected"), [(0, None), (1, None), (2, [1, 0, 1, 1, 0, 0])])
def test_faces_of_slots_that_are_not_there_have_the_last_one(materials: int, expected: list[int] | None) -> None:
    """As Blender shows them; joined meshes are left so."""
    mesh = box()
    for number in range(materials):
        mesh.materials.append(bpy.data.materials.new(f"Paint {number}"))
    mesh.polygons.foreach_set("material_index", [7, 0, 1, 9, 0, 0])
    add("Wall", mesh)
    found = read_scene().meshes[0]
    check_mesh(found)
    assert (found.material_index is None) == (expected is None)
    if found.material_index is not None:
        assert found.material_index.tolist() == expected
