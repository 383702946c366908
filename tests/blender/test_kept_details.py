"""Details that are kept or left away as Blender has them: normals, empties that show a collection, open actions."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from tests.blender.helpers import add, box
from tests.blender.test_instances import drawn_boxes, nested_collections
from unisg_blender.blender import read_scene, write_scene
from unisg_blender.formats.linked_files import files_beside


@pytest.mark.parametrize(("smooth", "kept"), [((), False), ((0,), True), (range(6), True)])
def test_normals_are_kept_where_something_is_smooth(smooth: tuple[int, ...], kept: bool) -> None:
    mesh = box()
    for face in smooth:
        mesh.polygons[face].use_smooth = True
    add("Box", mesh)
    found = read_scene().meshes[0]
    assert (found.normals is not None) == kept
    if kept:
        np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1, atol=1e-4)


def test_a_mesh_without_faces_has_no_normals() -> None:
    points = bpy.data.meshes.new("Points")
    points.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    add("Line", points)
    found = read_scene().meshes[0]
    assert found.normals is None
    assert found.edges.tolist() == [[0, 1]]


def test_an_empty_with_one_straight_copy_shows_its_collection_itself() -> None:
    nested_collections()
    expected = drawn_boxes()
    again = write_scene(read_scene())
    holders = [item for item in bpy.data.objects if item.name.startswith("Holder.")]
    (holder,) = [item for item in holders if item.instance_collection is not None]
    np.testing.assert_allclose(holder.instance_collection.instance_offset, (0.5, 0.25, 0), atol=1e-6)
    assert not [item.name for item in again.objects if " instance " in item.name]
    bpy.context.window.scene = again
    np.testing.assert_allclose(drawn_boxes(), expected, atol=1e-5)


def test_two_empties_share_a_collection_and_one_elsewhere_has_a_helper() -> None:
    source = bpy.data.collections.new("Source")
    source.objects.link(bpy.data.objects.new("Thing", box()))
    for number in range(2):
        item = add(f"Copy {number}")
        item.instance_type, item.instance_collection, item.location = "COLLECTION", source, (2 * number, 0, 0)
    graph = read_scene()
    entries = graph.components["instances"]
    for column in entries.columns["matrix"]:
        np.testing.assert_allclose(column, np.eye(4))
    entries.columns["matrix"][1][:3, 3] = 0, 0, 1
    again = write_scene(graph)
    assert len([item for item in again.objects if " instance " in item.name]) == 1
    bpy.context.window.scene = again
    np.testing.assert_allclose(drawn_boxes()[:, [3, 7, 11]], [[0, 0, 0], [2, 0, 1]], atol=1e-6)


def test_files_beside_are_those_of_the_format(tmp_path) -> None:  # type: ignore[no-untyped-def]
    gltf, obj, other = tmp_path / "a.gltf", tmp_path / "a.obj", tmp_path / "a.glb"
    gltf.write_text('{"buffers": [{"uri": "my%20data.bin"}, {"uri": "data:abc"}, {}]}')
    obj.write_text("mtllib one.mtl\nv 0 0 0\n# mtllib no.mtl\nmtllib  two.mtl \n")
    other.write_bytes(b"mtllib never.mtl\n")
    assert [path.name for path in files_beside(gltf)] == ["my data.bin"]
    assert [path.name for path in files_beside(obj)] == ["one.mtl", "two.mtl"]
    assert files_beside(other) == []
