"""Two scenegraphs hold the same: entity by entity, array by array, component by component."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from unisg_blender.scene import Mesh, SceneGraph, Table, frame_range_of, world_matrices

RELATIVE = 1e-5


def assert_same_graph(first: SceneGraph, second: SceneGraph) -> None:
    """All columns, meshes, materials and components agree; matrices to 1e-5 relative."""
    assert second.name == first.name
    assert second.uid == first.uid
    assert second.title == first.title
    assert second.vocabulary == first.vocabulary
    assert frame_range_of(second) == frame_range_of(first)
    for column in ("type", "parent", "category"):
        np.testing.assert_array_equal(getattr(second, column), getattr(first, column), err_msg=column)
    assert_close(second.local, first.local)
    assert_close(world_matrices(second), world_matrices(first))
    np.testing.assert_array_equal(second.mesh >= 0, first.mesh >= 0)
    for row in np.flatnonzero(first.mesh >= 0):
        assert_same_mesh(first.meshes[first.mesh[row]], second.meshes[second.mesh[row]])
    assert sharing(second) == sharing(first)
    assert set(first.components) == set(second.components)
    for name, table in first.components.items():
        assert_same_table(name, table, second.components[name])


def assert_close(found: np.ndarray, expected: np.ndarray) -> None:
    """Matrices agree to 1e-5 of their largest entry."""
    assert found.shape == expected.shape
    size = np.abs(expected).max(axis=(-1, -2), keepdims=True, initial=1e-12)
    assert (np.abs(found - expected) <= RELATIVE * size).all()


def sharing(graph: SceneGraph) -> list[int]:
    """For every entity the first one that has the same mesh."""
    first: dict[int, int] = {}
    return [first.setdefault(int(mesh), row) if mesh >= 0 else -1 for row, mesh in enumerate(graph.mesh)]


def assert_same_mesh(first: Mesh, second: Mesh) -> None:
    """All arrays, layers and material slots agree."""
    assert second.name == first.name
    for name in ("points", "corners", "offsets", "edges"):
        found, expected = getattr(second, name), getattr(first, name)
        assert found.dtype == expected.dtype, name
        np.testing.assert_array_equal(found, expected, err_msg=name)
    assert (first.normals is None) == (second.normals is None)
    if first.normals is not None:
        np.testing.assert_array_equal(second.normals, first.normals)
    assert list(first.uvs) == list(second.uvs)
    for name in first.uvs:
        np.testing.assert_array_equal(second.uvs[name], first.uvs[name])
    assert second.materials == first.materials
    faces = len(first.offsets) - 1
    slots = [np.zeros(faces, int) if mesh.material_index is None else mesh.material_index for mesh in (first, second)]
    np.testing.assert_array_equal(slots[1], slots[0])


def assert_same_table(name: str, first: Table, second: Table) -> None:
    """Rows and columns of a component agree; an entity's relations and instances in any order."""
    if name == "relations":
        assert _pairs(first) == _pairs(second)
        return
    if name == "instances":
        first, second = _by_place(first), _by_place(second)
    np.testing.assert_array_equal(second.rows, first.rows, err_msg=name)
    assert set(first.columns) == set(second.columns), name
    for key, expected in first.columns.items():
        found = second.columns[key]
        assert found.dtype.kind == expected.dtype.kind, (name, key)
        assert len(found) == len(expected)
        for one, other in zip(expected, found, strict=True):
            _assert_same_value(f"{name}.{key}", one, other)


def _by_place(table: Table) -> Table:
    titles = [prototype.title for prototype in table.columns["prototype"]]
    places = [matrix.tolist() for matrix in table.columns["matrix"]]
    order = sorted(range(len(titles)), key=lambda item: (table.rows[item], titles[item], places[item]))
    return Table(table.rows[order], {name: column[order] for name, column in table.columns.items()})


def _pairs(table: Table) -> set[tuple[int, str, str]]:
    return set(zip(table.rows.tolist(), table.columns["kind"], table.columns["target"], strict=True))


def _assert_same_value(name: str, first: Any, second: Any) -> None:
    if isinstance(first, SceneGraph):
        assert_same_graph(first, second)
    elif isinstance(first, np.ndarray | float):
        np.testing.assert_allclose(second, first, rtol=1e-9, atol=1e-12, err_msg=name)
    elif name == "properties.json":
        assert json.loads(second) == json.loads(first)
    else:
        assert second == first, name
