"""Meshes and materials: plain arrays in the object's frame."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import UniSGError

BOX_FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
"""The faces of a box whose corners come in the order of x, then y, then z, low before high."""


@dataclass(frozen=True)
class Material:
    """A material by name, with the colour that a viewer shows.

    ``base_color`` is linear RGBA in 0..1; ``metallic`` and ``roughness`` are
    those of a preview surface.
    """

    name: str
    base_color: tuple[float, float, float, float] = (0.8, 0.8, 0.8, 1.0)
    metallic: float = 0.0
    roughness: float = 0.5


@dataclass(frozen=True, eq=False)
class Mesh:
    """A polygon mesh, stored once however many entities share it.

    Attributes
    ----------
    name
        Name of the mesh data, not of the object.
    points
        float32 (V, 3), metres, object frame.
    corners
        int32 (C,): point of each face corner, faces one after another.
    offsets
        int32 (F + 1,): face f has corners ``corners[offsets[f]:offsets[f + 1]]``.
    edges
        int32 (E, 2): edges that belong to no face.
    normals
        float32 (C, 3) unit normals of the corners, or None for flat faces.
    uvs
        float32 (C, 2) arrays by layer name.
    material_index
        int32 (F,): slot of each face in ``materials``.
    materials
        Names of the materials in the mesh's slots.
    """

    name: str
    points: NDArray[np.float32]
    corners: NDArray[np.int32]
    offsets: NDArray[np.int32]
    edges: NDArray[np.int32] = field(default_factory=lambda: np.zeros((0, 2), np.int32))
    normals: NDArray[np.float32] | None = None
    uvs: dict[str, NDArray[np.float32]] = field(default_factory=dict)
    material_index: NDArray[np.int32] | None = None
    materials: tuple[str, ...] = ()

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """float64 (2, 3): lowest and highest corner of the box around the finite points; zeros if there are none."""
        finite = self.points[np.isfinite(self.points).all(axis=1)]
        if not len(finite):
            return np.zeros((2, 3))
        return np.stack([finite.min(axis=0), finite.max(axis=0)]).astype(np.float64)

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        """int32 (T, 3): the faces as fans of triangles."""
        sizes = self.offsets[1:] - self.offsets[:-1]
        size = int(sizes[0]) if len(sizes) else 0
        if size > 2 and len(self.corners) == size * len(sizes) and (sizes == size).all():  # all alike, as mostly
            fan = np.array([(0, step, step + 1) for step in range(1, size - 1)])
            return self.corners.reshape(-1, size)[:, fan].reshape(-1, 3)
        fans = np.maximum(sizes - 2, 0)
        first = np.repeat(self.offsets[:-1], fans)
        step = np.arange(fans.sum()) - np.repeat(np.cumsum(fans) - fans, fans)
        picked = np.stack([first, first + step + 1, first + step + 2], axis=1)
        return self.corners[picked].astype(np.int32)

    @property
    def following(self) -> NDArray[np.int64]:
        """int64 (C,): number of the corner that follows each corner in its face."""
        result = np.arange(1, len(self.corners) + 1)
        filled = np.diff(self.offsets) > 0
        result[self.offsets[1:][filled] - 1] = self.offsets[:-1][filled]
        return result

    @cached_property
    def checksum(self) -> str:
        """Hexadecimal digest of the geometry: points, faces and loose edges."""
        digest = hashlib.blake2b(digest_size=16)
        for array in (self.points, self.corners, self.offsets, self.edges):
            digest.update(np.ascontiguousarray(array).tobytes())
            digest.update(str(array.shape).encode())
        return digest.hexdigest()


def shown_slots(index: NDArray[np.int32], slots: int) -> NDArray[np.int32]:
    """The material slot that Blender shows on each face (F,): a stored number beyond the slots stands for the last."""
    return np.clip(index, 0, max(slots - 1, 0)).astype(np.int32)


def check_mesh(mesh: Mesh) -> None:
    """UniSGError if the arrays of a mesh have other types, shapes or ranges than :class:`Mesh` says."""
    corners, faces, slots = len(mesh.corners), len(mesh.offsets) - 1, max(len(mesh.materials), 1)
    wanted: dict[str, tuple[NDArray[Any] | None, type, tuple[int | None, ...], int | None]] = {
        "points": (mesh.points, np.float32, (None, 3), None),
        "corners": (mesh.corners, np.int32, (None,), len(mesh.points)),
        "offsets": (mesh.offsets, np.int32, (None,), corners + 1),
        "edges": (mesh.edges, np.int32, (None, 2), len(mesh.points)),
        "normals": (mesh.normals, np.float32, (corners, 3), None),
        "material_index": (mesh.material_index, np.int32, (faces,), slots),
    }
    wanted |= {f"uv {layer}": (values, np.float32, (corners, 2), None) for layer, values in mesh.uvs.items()}
    for name, (values, kind, shape, end) in wanted.items():
        if values is None:
            continue
        fits = values.ndim == len(shape) and all(
            size in (None, found) for size, found in zip(shape, values.shape, strict=True)
        )
        if not fits or values.dtype != kind:
            raise UniSGError(f"the {name} of the mesh {mesh.name!r} have another type or shape")
        if end is not None and values.size and not (values.min() >= 0 and values.max() < end):
            raise UniSGError(f"the {name} of the mesh {mesh.name!r} are out of their range")
    whole = faces >= 0 and mesh.offsets[0] == 0 and mesh.offsets[-1] == corners
    if not whole or (np.diff(mesh.offsets) < 0).any():
        raise UniSGError(f"the offsets of the mesh {mesh.name!r} do not fit its corners")


def mesh_from_faces(name: str, points: NDArray[np.floating], faces: list[list[int]] | NDArray[np.integer]) -> Mesh:
    """A mesh from points (V, 3) in metres and faces given as lists of point numbers."""
    sizes = [len(face) for face in faces]
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32)
    corners = np.concatenate([np.asarray(face, np.int32) for face in faces]) if sizes else np.zeros(0, np.int32)
    return Mesh(name, np.asarray(points, np.float32).reshape(-1, 3), corners.astype(np.int32), offsets)


def box_mesh(name: str, size: ArrayLike, bottom: float = 0.0) -> Mesh:
    """The mesh of a box of a size (3,) in metres on the origin, or with its bottom ``bottom`` heights above it."""
    ends = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (bottom, bottom + 1)], np.float64)
    return mesh_from_faces(name, ends * np.asarray(size, np.float64), BOX_FACES)
