"""Small objects that several tests of this room need."""

from __future__ import annotations

import re

import bpy
import numpy as np

from unisg_blender.scene import SceneGraph, world_matrices

TOLERANCE = 1e-5
NORMALS = 1e-4 if bpy.app.version >= (4, 5) else 0.0142  # before, Blender merges custom normals within 0.8 degrees
COMPARED = (
    "parenting", "collections", "visibility", "materials", "camera", "light", "bones", "empty", "properties",
)  # fmt: skip


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
    """Largest difference of two arrays, relative to the largest number of the second."""
    gap, size = np.abs(np.asarray(first) - np.asarray(second)), np.abs(second)
    return float(gap.max(initial=0) / max(size.max(initial=0), 1e-12))


def assert_stands_like_blender(graph: SceneGraph, scene: bpy.types.Scene | None = None) -> None:
    """Parents are those of the objects, and world matrices are ``matrix_world``, in metres, to 1e-5."""
    scene = scene or bpy.context.scene
    metres = 1.0 if scene.unit_settings.system == "NONE" else scene.unit_settings.scale_length
    objects = {item.name: item for item in scene.objects}
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert sorted(graph.name) == sorted(objects)
    world = world_matrices(graph)
    for row, name in enumerate(graph.name):
        item = objects[name]
        above = graph.parent[row]
        assert (graph.name[above] if above >= 0 else None) == (item.parent.name if item.parent else None)
        if item.evaluated_get(depsgraph).is_evaluated:
            expected = np.array(item.matrix_world)
            expected[:3, 3] *= metres
            assert relative_gap(world[row], expected) < TOLERANCE, name


def assert_same_scene(first: SceneGraph, second: SceneGraph, points: float = 0.0) -> None:
    """Two scenegraphs have the same entities, by uid: names, types, parents, categories, world matrices, meshes.

    ``points``: how far apart those of meshes may be, in metres.
    """
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
            _assert_same_mesh(first.meshes[first.mesh[row]], second.meshes[second.mesh[other]], points)

    for name in COMPARED:
        _assert_same_component(first, second, name)
    assert first.frames in (None, second.frames)
    _assert_same_instances(first, second, points)


def _assert_same_component(first: SceneGraph, second: SceneGraph, name: str) -> None:
    """The entries of a component are the same for every uid, whatever the order of rows."""
    assert (name in first.components) == (name in second.components), name
    for uid, row in first.row_of_uid.items() if name in first.components else ():
        here, there = first[row].component(name), second[second.row_of_uid[uid]].component(name)
        for key, values in here.items():
            if key == "data":  # names of data-blocks, which Blender makes unique
                continue
            if values.dtype == object or values.dtype == bool:
                assert _texts(values) == _texts(there[key]), (name, key, first.name[row])
            else:
                assert there[key].shape == values.shape
                assert relative_gap(there[key], values) < TOLERANCE, (name, key, first.name[row])


def _texts(values: np.ndarray) -> list[str]:
    """Sorted, without the numbers that Blender adds where several data-blocks ask for one name."""
    return sorted(re.sub(r"\.\d{3}\b", "", str(value)) for value in values)


def _assert_same_instances(first: SceneGraph, second: SceneGraph, points: float) -> None:
    for uid, row in first.row_of_uid.items():
        here, there = first[row].component("instances"), second[second.row_of_uid[uid]].component("instances")
        assert len(here.get("matrix", ())) == len(there.get("matrix", ())), first.name[row]
        for place in range(len(here.get("matrix", ()))):
            assert relative_gap(there["matrix"][place], here["matrix"][place]) < TOLERANCE
            assert_same_scene(here["prototype"][place], there["prototype"][place], points)


def _parent_uid(graph: SceneGraph, row: int) -> str:
    return graph.uid[graph.parent[row]] if graph.parent[row] >= 0 else ""


def _assert_same_mesh(first, second, points: float) -> None:
    np.testing.assert_allclose(first.points, second.points, rtol=0, atol=points)
    np.testing.assert_array_equal(first.corners, second.corners)
    np.testing.assert_array_equal(first.offsets, second.offsets)
    assert first.materials == second.materials
    assert list(first.uvs) == list(second.uvs)
    for name, values in first.uvs.items():
        np.testing.assert_array_equal(values, second.uvs[name])
    assert (first.normals is None) == (second.normals is None)
    if first.normals is not None:
        assert np.abs(first.normals - second.normals).max(initial=0) < NORMALS
