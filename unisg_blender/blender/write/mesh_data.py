"""Plain arrays as Blender meshes."""

from __future__ import annotations

from collections.abc import Mapping

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...scene.mesh import Mesh

CUSTOM = 1e-4  # normals that differ less are Blender's own
FREE_NORMALS = bpy.app.version >= (4, 5, 0)  # before, Blender keeps 16 bits and merges normals within 0.8 degrees


def write_mesh(mesh: Mesh, materials: Mapping[str, bpy.types.Material]) -> bpy.types.Mesh:
    """A new Blender mesh; faces that Blender cannot hold are removed by its own validation.

    Raises
    ------
    UniSGError
        If the arrays contradict each other (a corner that names no point ...).
    """
    check_mesh(mesh)
    made = bpy.data.meshes.new(mesh.name)
    sizes = np.diff(mesh.offsets)
    made.vertices.add(len(mesh.points))
    if len(mesh.points):
        made.attributes["position"].data.foreach_set("vector", np.ascontiguousarray(mesh.points, np.float32).ravel())
    if len(mesh.edges):
        made.edges.add(len(mesh.edges))
        made.edges.foreach_set("vertices", np.ascontiguousarray(mesh.edges, np.int32).ravel())
    if len(sizes):
        made.loops.add(len(mesh.corners))
        made.loops.foreach_set("vertex_index", np.ascontiguousarray(mesh.corners, np.int32))
        made.polygons.add(len(sizes))
        made.polygons.foreach_set("loop_start", np.ascontiguousarray(mesh.offsets[:-1], np.int32))
    for name in mesh.materials:
        made.materials.append(materials.get(name))
    if mesh.material_index is not None and len(sizes):
        made.polygons.foreach_set("material_index", np.ascontiguousarray(mesh.material_index, np.int32))
    for name, values in mesh.uvs.items():
        layer = made.uv_layers.new(name=name, do_init=False)
        if layer is not None and len(mesh.corners):
            layer.uv.foreach_set("vector", np.ascontiguousarray(values, np.float32).ravel())
    made.update(calc_edges=True)
    changed = made.validate(clean_customdata=False)
    if len(sizes):
        _set_normals(made, None if changed else mesh.normals)
    return made


def check_mesh(mesh: Mesh) -> None:
    """Raise UniSGError where wrong numbers would make Blender read outside its arrays."""
    count = len(mesh.points)
    offsets, corners = mesh.offsets, mesh.corners
    sound = (
        mesh.points.shape == (count, 3)
        and len(offsets) > 0
        and offsets[0] == 0
        and offsets[-1] == len(corners)
        and bool((np.diff(offsets) >= 0).all())
        and (not len(corners) or (corners.min() >= 0 and corners.max() < count))
        and (not len(mesh.edges) or (mesh.edges.min() >= 0 and mesh.edges.max() < count))
        and all(values.shape == (len(corners), 2) for values in mesh.uvs.values())
        and (mesh.normals is None or mesh.normals.shape == (len(corners), 3))
        and (mesh.material_index is None or len(mesh.material_index) == len(offsets) - 1)
    )
    if not sound:
        raise UniSGError(f"mesh {mesh.name!r} is damaged: its faces, points and layers do not fit together")


def _set_normals(made: bpy.types.Mesh, normals: NDArray[np.float32] | None) -> None:
    """Flat faces without normals; else smooth ones, with custom normals where Blender's own are others."""
    smooth = np.zeros(len(made.polygons), bool)
    if normals is None:
        made.polygons.foreach_set("use_smooth", smooth)
        return
    smooth[:] = True
    made.polygons.foreach_set("use_smooth", smooth)
    own = np.empty((len(made.loops), 3), np.float32)
    made.corner_normals.foreach_get("vector", own.ravel())
    if np.abs(own - normals).max(initial=0) <= CUSTOM:
        return
    if FREE_NORMALS:
        layer = made.attributes.new("custom_normal", "FLOAT_VECTOR", "CORNER")
        layer.data.foreach_set("vector", np.ascontiguousarray(normals, np.float32).ravel())
        made.update()
    else:
        made.normals_split_custom_set(normals.tolist())
