"""Blender meshes as plain arrays."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...scene.mesh import Mesh, shown_slots


def read_mesh(mesh: bpy.types.Mesh, name: str = "") -> Mesh:
    """Points, faces, loose edges, corner normals (None where all faces are flat), UVs and material slots.

    Raises
    ------
    UniSGError
        If its numbers do not fit together, as those of a damaged file.
    """
    try:
        found = _read_arrays(mesh, name)
    except (LookupError, TypeError):  # attributes that are missing, or shorter than what they are of
        found = None
    if found is None or not _is_sound(found):
        raise UniSGError(f"the mesh {mesh.name!r} is damaged: its faces and edges do not fit its points")
    return found


def _is_sound(mesh: Mesh) -> bool:
    """Whether all points and corners that are referred to are there."""
    used = max((part.view(np.uint32).max(initial=0) for part in (mesh.corners, mesh.edges)), default=0)
    empty = not len(mesh.corners) and not len(mesh.edges)
    return (empty or int(used) < len(mesh.points)) and bool((np.diff(mesh.offsets) >= 0).all() and mesh.offsets[0] == 0)


def _read_arrays(mesh: bpy.types.Mesh, name: str) -> Mesh:
    attributes = mesh.attributes
    points, corners, faces = len(mesh.vertices), len(mesh.loops), len(mesh.polygons)
    offsets = np.full(faces + 1, corners, np.int32)
    if faces:
        mesh.polygons.foreach_get("loop_start", offsets[:-1])
    index = attributes.get("material_index") if faces else None
    return Mesh(
        name=name or mesh.name,
        points=_values(attributes, "position", "vector", points, 3, np.float32),
        corners=_values(attributes, ".corner_vert", "value", corners, 1, np.int32).ravel(),
        offsets=offsets,
        edges=_loose_edges(mesh),
        normals=_corner_normals(mesh, corners) if corners and mesh.normals_domain != "FACE" else None,
        uvs={layer.name: _values(attributes, layer.name, "vector", corners, 2, np.float32) for layer in mesh.uv_layers},
        material_index=None if index is None else _material_index(attributes, faces, len(mesh.materials)),
        materials=tuple("" if material is None else material.name for material in mesh.materials),
    )


def _values(
    attributes: bpy.types.AttributeGroup, name: str, field: str, count: int, width: int, dtype: type
) -> NDArray:
    """An attribute's values (count, width): reading attributes copies memory, ten times faster than mesh elements."""
    values: NDArray = np.empty((count, width), dtype)
    if count:
        attributes[name].data.foreach_get(field, values.ravel())
    return values


def _material_index(attributes: bpy.types.AttributeGroup, faces: int, slots: int) -> NDArray[np.int32] | None:
    index = shown_slots(_values(attributes, "material_index", "value", faces, 1, np.int32).ravel(), slots)
    return index if index.any() else None


def _loose_edges(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    count, corners = len(mesh.edges), len(mesh.loops)
    used = np.zeros(count, bool)
    if corners:
        edge = _values(mesh.attributes, ".corner_edge", "value", corners, 1, np.int32).ravel()
        used[edge.view(np.uint32)] = True  # -1 is no edge either
    if used.all():
        return np.zeros((0, 2), np.int32)
    return _edge_points(mesh, count)[~used]


def _edge_points(mesh: bpy.types.Mesh, count: int) -> NDArray[np.int32]:
    points = np.empty((count, 2), np.int32)
    mesh.edges.foreach_get("vertices", points.ravel())
    return points


def _corner_normals(mesh: bpy.types.Mesh, count: int) -> NDArray[np.float32]:
    normals = np.empty((count, 3), np.float32)
    mesh.corner_normals.foreach_get("vector", normals.ravel())
    squares = np.einsum("ij,ij->i", normals, normals)
    odd = np.abs(squares - 1) > 1e-4  # on faces without area, Blender's have any length
    if odd.any():
        normals[odd] /= np.sqrt(np.where(squares > 0, squares, 1))[odd, None]
    return normals
