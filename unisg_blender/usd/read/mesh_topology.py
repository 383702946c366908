"""The arrays of a UsdGeomMesh, checked and in the scenegraph's layout."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom

from .. import schema

UV_TYPES = frozenset(("texCoord2f[]", "texCoord2d[]", "texCoord2h[]", "float2[]"))
NOW = Usd.TimeCode.EarliestTime()


@dataclass(frozen=True, eq=False)
class Topology:
    """Arrays as in :class:`~unisg_blender.scene.mesh.Mesh`, in the stage's frame."""

    points: NDArray[np.float32]
    corners: NDArray[np.int32]
    offsets: NDArray[np.int32]
    edges: NDArray[np.int32] = field(default_factory=lambda: np.zeros((0, 2), np.int32))
    normals: NDArray[np.float32] | None = None
    uvs: dict[str, NDArray[np.float32]] = field(default_factory=dict)


def array(attribute: Any, dtype: Any, width: int = 1) -> NDArray[Any]:
    """An attribute's value, at the default time or the first sample, as (K, width), or (K,) for width 1.

    Nothing where the file gives it a type that holds no numbers.
    """
    value = attribute.Get() if attribute else None
    if value is None and attribute:
        value = attribute.Get(NOW)
    try:
        found = np.array(() if value is None else value, dtype)
    except (TypeError, ValueError):
        found = np.zeros(0, dtype)
    return found.reshape(-1, width) if width > 1 else found.reshape(-1)


def read_topology(prim: Any) -> Topology:
    """Read a mesh prim. Faces of damaged meshes are left out, which is told in a warning."""
    mesh = UsdGeom.Mesh(prim)
    points = array(mesh.GetPointsAttr(), np.float32, 3)
    sizes = array(mesh.GetFaceVertexCountsAttr(), np.int64)
    corners = array(mesh.GetFaceVertexIndicesAttr(), np.int32)
    problem = _problem(len(points), sizes, corners)
    if problem:
        warnings.warn(f"{prim.GetPath()}: {problem}; its faces are left out", stacklevel=2)
        sizes, corners = sizes[:0], corners[:0]
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32)
    turn = _reversing(offsets) if mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded else None
    stored_edges = array(prim.GetAttribute(schema.EDGES), np.int32)
    edges = stored_edges[: len(stored_edges) // 2 * 2].reshape(-1, 2)
    if len(edges) and (edges.min() < 0 or edges.max() >= len(points)):
        warnings.warn(f"{prim.GetPath()}: loose edges name points that are not there; left out", stacklevel=2)
        edges = edges[:0]
    normals, uvs = _read_normals(mesh, corners, offsets), _read_uvs(prim, corners, offsets)
    if turn is not None:
        corners = corners[turn]
        normals = None if normals is None else normals[turn]
        uvs = {name: values[turn] for name, values in uvs.items()}
    return Topology(points, corners, offsets, edges, normals, uvs)


def _problem(points: int, sizes: NDArray[np.int64], corners: NDArray[np.int32]) -> str:
    if len(sizes) and sizes.min() < 0:
        return "faces with a negative number of corners"
    if sizes.sum() != len(corners):
        return f"{int(sizes.sum())} corners announced, {len(corners)} given"
    if len(corners) and (corners.min() < 0 or corners.max() >= points):
        return "faces name points that are not there"
    return ""


def _reversing(offsets: NDArray[np.int32]) -> NDArray[np.int64]:
    """Corner numbers that turn every face around."""
    sizes = np.diff(offsets)
    return np.repeat(offsets[:-1] + offsets[1:] - 1, sizes) - np.arange(offsets[-1])


def _read_normals(mesh: Any, corners: NDArray[np.int32], offsets: NDArray[np.int32]) -> NDArray[np.float32] | None:
    primvar = UsdGeom.PrimvarsAPI(mesh.GetPrim()).GetPrimvar("normals")
    if primvar and primvar.HasAuthoredValue():
        return _on_corners(_primvar_values(primvar, 3), primvar.GetInterpolation(), corners, offsets)
    if not mesh.GetNormalsAttr().HasAuthoredValue():
        return None
    values = array(mesh.GetNormalsAttr(), np.float32, 3)
    return _on_corners(values, mesh.GetNormalsInterpolation(), corners, offsets)


def _read_uvs(prim: Any, corners: NDArray[np.int32], offsets: NDArray[np.int32]) -> dict[str, NDArray[np.float32]]:
    uvs = {}
    for primvar in UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithAuthoredValues():
        if str(primvar.GetTypeName()) not in UV_TYPES:
            continue
        values = _on_corners(_primvar_values(primvar, 2), primvar.GetInterpolation(), corners, offsets)
        if values is not None:
            name = primvar.GetAttr().GetMetadata("displayName") or primvar.GetPrimvarName()
            uvs[str(name)] = values
    return uvs


def _primvar_values(primvar: Any, width: int) -> NDArray[np.float32]:
    values = array(primvar.GetAttr(), np.float32, width)
    if not primvar.IsIndexed():
        return values
    places = array(primvar.GetIndicesAttr(), np.int64)
    if len(places) and (places.min() < 0 or places.max() >= len(values)):
        return values[:0]
    return values[places]


def _on_corners(
    values: NDArray[np.float32], interpolation: str, corners: NDArray[np.int32], offsets: NDArray[np.int32]
) -> NDArray[np.float32] | None:
    """Values per point, face or mesh spread to the corners; None if their number does not fit."""
    if interpolation == "faceVarying" and len(values) == len(corners):
        return values
    if interpolation in ("vertex", "varying") and len(values) > corners.max(initial=-1):
        return values[corners]
    if interpolation == "uniform" and len(values) == len(offsets) - 1:
        return np.repeat(values, np.diff(offsets), axis=0)
    if interpolation == "constant" and len(values) == 1:
        return np.repeat(values, len(corners), axis=0)
    return None
