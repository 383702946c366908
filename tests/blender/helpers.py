"""Small things that several tests of this room need."""

from __future__ import annotations

import bpy
import numpy as np

from unisg_blender.scene import SceneGraph, world_matrices

TOLERANCE = 1e-5


def add(name: str, data: bpy.types.ID | None = None, parent: bpy.types.Object | None = None) -> bpy.types.Object:
    """A new object in the current scene."""
    item = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(item)
    item.parent = parent
    return item


def box(name: str = "Box", size: float = 1.0) -> bpy.types.Mesh:
    """A cube mesh around the origin."""
    mesh = bpy.data.meshes.new(name)
    corners = [(x * size, y * size, z * size) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh.from_pydata(corners, [], faces)
    return mesh


def relative_gap(first: np.ndarray, second: np.ndarray) -> float:
    """Largest difference of two matrices, relative to the second."""
    return float(np.abs(np.asarray(first) - np.asarray(second)).max() / max(np.abs(second).max(), 1e-12))


def assert_stands_like_blender(graph: SceneGraph, scene: bpy.types.Scene | None = None) -> None:
    """Parents are those of the objects, and world matrices are ``matrix_world`` to 1e-5."""
    scene = scene or bpy.context.scene
    objects = {item.name: item for item in scene.objects}
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert sorted(graph.name) == sorted(objects)
    world = world_matrices(graph)
    for row, name in enumerate(graph.name):
        item = objects[name]
        above = graph.parent[row]
        assert (graph.name[above] if above >= 0 else None) == (item.parent.name if item.parent else None)
        if item.evaluated_get(depsgraph).is_evaluated:
            assert relative_gap(world[row], np.array(item.matrix_world)) < TOLERANCE, name


def assert_same_scene(first: SceneGraph, second: SceneGraph) -> None:
    """Two scenegraphs have the same entities, by uid: names, types, parents, categories, world matrices, meshes."""
    assert set(first.uid) == set(second.uid)
    worlds = world_matrices(first), world_matrices(second)
    for row, uid in enumerate(first.uid):
        other = second.row_of_uid[uid]
        assert first.type[row] == second.type[other], first.name[row]
        assert first.category_name(row) == second.category_name(other)
        assert _parent_uid(first, row) == _parent_uid(second, other), first.name[row]
        assert relative_gap(worlds[1][other], worlds[0][row]) < TOLERANCE, first.name[row]
        assert (first.mesh[row] >= 0) == (second.mesh[other] >= 0)
        if first.mesh[row] >= 0:
            _assert_same_mesh(first.meshes[first.mesh[row]], second.meshes[second.mesh[other]])


def _parent_uid(graph: SceneGraph, row: int) -> str:
    return graph.uid[graph.parent[row]] if graph.parent[row] >= 0 else ""


def _assert_same_mesh(first, second) -> None:
    np.testing.assert_array_equal(first.points, second.points)
    np.testing.assert_array_equal(first.corners, second.corners)
    np.testing.assert_array_equal(first.offsets, second.offsets)
    assert first.materials == second.materials
    assert list(first.uvs) == list(second.uvs)
    for name, values in first.uvs.items():
        np.testing.assert_array_equal(values, second.uvs[name])
    assert (first.normals is None) == (second.normals is None)
    if first.normals is not None:
        assert np.abs(first.normals - second.normals).max(initial=0) < 2e-3  # custom normals have 16 bits in Blender
