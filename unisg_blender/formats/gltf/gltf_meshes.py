"""Polygon meshes as glTF meshes: triangles by material, vertices where points, normals and UVs agree, loose edges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.y_up import turned_points
from ...meshes.triangulate import inner_triangles
from ...scene import Material, Mesh
from .gltf_buffers import INDICES, VERTICES, Buffers

TRIANGLES, LINES = 4, 1
DOWNWARD = np.array([1, -1], np.float32)
"""How v runs in glTF: 1 - v."""
UV_LAYERS = 2
"""More layers than these are not shown by all viewers, and not written."""


class MeshWriter:
    """Meshes and materials of a file, each written once, as they are asked for."""

    def __init__(self, buffers: Buffers, materials: Mapping[str, Material]) -> None:
        self.meshes: list[dict[str, Any]] = []
        self.materials = [_material(each) for each in materials.values()]
        self._numbers = {name: number for number, name in enumerate(materials)}
        self._buffers = buffers
        self._shapes: dict[Mesh, list[tuple[int, dict[str, Any]]]] = {}
        self._written: dict[tuple[Mesh, tuple[str, ...]], int | None] = {}

    def number(self, mesh: Mesh, slots: Sequence[str]) -> int | None:
        """The number of a mesh with these materials in its slots; None if there is nothing to be seen."""
        key = (mesh, tuple(slots))
        if key not in self._written:
            if mesh not in self._shapes:
                self._shapes[mesh] = list(_primitives(mesh, self._buffers))
            primitives = [self._with_material(shape, slots, slot) for slot, shape in self._shapes[mesh]]
            self._written[key] = len(self.meshes) if primitives else None
            if primitives:
                self.meshes.append({"name": mesh.name, "primitives": primitives})
        return self._written[key]

    def _with_material(self, shape: dict[str, Any], slots: Sequence[str], slot: int) -> dict[str, Any]:
        name = slots[min(slot, len(slots) - 1)] if slots else ""
        return shape | ({"material": self._numbers[name]} if name in self._numbers else {})


def _material(material: Material) -> dict[str, Any]:
    color = [min(max(float(part), 0.0), 1.0) for part in material.base_color]
    surface = {"baseColorFactor": color, "metallicFactor": material.metallic, "roughnessFactor": material.roughness}
    record = {"name": material.name, "pbrMetallicRoughness": surface, "doubleSided": True}
    return record | ({"alphaMode": "BLEND"} if color[3] < 1 else {})


def _primitives(mesh: Mesh, buffers: Buffers) -> list[tuple[int, dict[str, Any]]]:
    """Slot and record of each part of a mesh with one material; the parts share their vertices."""
    found: list[tuple[int, dict[str, Any]]] = []
    of_corner, corners = _vertices(mesh)
    triangles = _corner_triangles(mesh)
    if len(triangles):
        attributes = _attributes(mesh, corners, buffers)
        slots = np.zeros(len(mesh.offsets) - 1, int) if mesh.material_index is None else mesh.material_index
        slot = np.repeat(slots, np.diff(mesh.offsets))[triangles[:, 0]]
        for each in np.unique(slot).tolist():
            indices = of_corner[triangles[slot == each]].astype(np.uint32).ravel()
            shape = {"attributes": attributes, "indices": buffers.accessor(indices, INDICES), "mode": TRIANGLES}
            found.append((each, shape))
    used, ends = np.unique(mesh.edges, return_inverse=True)
    if len(used):
        points = _finite(turned_points(mesh.points[used]))
        place = buffers.accessor(points, VERTICES, bounds=True)
        indices = buffers.accessor(ends.astype(np.uint32).ravel(), INDICES)
        found.append((0, {"attributes": {"POSITION": place}, "indices": indices, "mode": LINES}))
    return found


def _corner_triangles(mesh: Mesh) -> NDArray[np.int32]:
    """Triangles (T, 3) of face corners instead of points."""
    apart = replace(mesh, points=mesh.points[mesh.corners], corners=np.arange(len(mesh.corners), dtype=np.int32))
    return inner_triangles(apart)


def _vertices(mesh: Mesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The vertex of each corner (C,), and a corner of each vertex (V,)."""
    columns: list[NDArray[Any]] = [mesh.corners[:, None].astype(np.int32)]
    columns += [values.view(np.int32) for values in (_normals(mesh), *_layers(mesh)) if len(values)]
    keys = np.ascontiguousarray(np.concatenate(columns, axis=1))
    whole = keys.view(np.dtype((np.void, keys.itemsize * keys.shape[1]))).ravel()
    _, first, inverse = np.unique(whole, return_index=True, return_inverse=True)
    return inverse.reshape(-1), first


def _attributes(mesh: Mesh, corners: NDArray[np.int64], buffers: Buffers) -> dict[str, int]:
    points = _finite(turned_points(mesh.points[mesh.corners[corners]]))
    normals = turned_points(_normals(mesh)[corners])
    found = {
        "POSITION": buffers.accessor(points, VERTICES, bounds=True),
        "NORMAL": buffers.accessor(normals, VERTICES),
    }
    for number, layer in enumerate(_layers(mesh)):
        flipped = _finite(layer[corners] * DOWNWARD + (DOWNWARD < 0))  # v goes down in glTF
        found[f"TEXCOORD_{number}"] = buffers.accessor(flipped, VERTICES)
    return found


def _layers(mesh: Mesh) -> list[NDArray[np.float32]]:
    return [np.ascontiguousarray(values) for values in list(mesh.uvs.values())[:UV_LAYERS]]


def _normals(mesh: Mesh) -> NDArray[np.float32]:
    """Unit normals (C, 3) of the corners; those of the faces where a mesh has none, or none of length 1."""
    here, after = mesh.points[mesh.corners].astype(np.float64), mesh.points[mesh.corners[mesh.following]]
    sizes = np.diff(mesh.offsets)
    face = np.repeat(np.arange(len(sizes)), sizes)
    areas = np.zeros((len(sizes), 3))
    with np.errstate(invalid="ignore", over="ignore"):
        np.add.at(areas, face, np.cross(here, after))
    flat = _units(areas, np.array([[0.0, 0.0, 1.0]]))[face]
    return (flat if mesh.normals is None else _units(mesh.normals.astype(np.float64), flat)).astype(np.float32)


def _units(vectors: NDArray[np.float64], instead: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors (K, 3) at length 1; others where they have no direction."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    sound = (length > 0) & np.isfinite(length)
    return np.where(sound, vectors / np.where(sound, length, 1), instead)


def _finite(values: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
