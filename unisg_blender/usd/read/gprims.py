"""Meshes for USD's other shapes: cubes, spheres, cylinders, cones, capsules, planes, curves, points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import UsdGeom

from .mesh_topology import Topology, array

SEGMENTS = 32
_TURN = {  # from the Z axis to the shape's own
    "X": np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]),
    "Y": np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]]),
    "Z": np.eye(3),
}


def shape_arrays(prim: Any) -> Topology:
    """The shape of a prim as a mesh; curves become edges along their control points."""
    name = prim.GetTypeName()
    if prim.IsA(UsdGeom.Curves):
        return _curves(prim)
    if prim.IsA(UsdGeom.PointBased):
        return Topology(array(UsdGeom.PointBased(prim).GetPointsAttr(), np.float32, 3), *_no_faces())
    profile, numbers = _profile(str(name), prim)
    if profile is None:
        return (
            _box(name, numbers) if name in ("Cube", "Plane") else Topology(np.zeros((0, 3), np.float32), *_no_faces())
        )
    return _turned_profile(profile, str(numbers.get("axis", "Z")))


def _no_faces() -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    return np.zeros(0, np.int32), np.zeros(1, np.int32)


def _profile(name: str, prim: Any) -> tuple[NDArray[np.float64] | None, dict[str, Any]]:
    """Outline (radius, height) from bottom to top of shapes with an axis; None for others."""
    numbers = {
        key: prim.GetAttribute(key).Get()
        for key in ("size", "radius", "radiusTop", "radiusBottom", "height", "width", "length", "axis")
        if prim.GetAttribute(key)
    }
    radius, half = numbers.get("radius") or 0.0, (numbers.get("height") or 0.0) / 2
    steps = np.linspace(-np.pi / 2, np.pi / 2, SEGMENTS // 2 + 1)
    arc = np.stack([np.cos(steps), np.sin(steps)], axis=1)
    arc[[0, -1], 0] = 0.0
    if name == "Sphere":
        return radius * arc, {}
    if name == "Cylinder":
        return np.array([[0, -half], [radius, -half], [radius, half], [0, half]]), numbers
    if name == "Cylinder_1":
        bottom, top = numbers["radiusBottom"], numbers["radiusTop"]
        return np.array([[0, -half], [bottom, -half], [top, half], [0, half]]), numbers
    if name == "Cone":
        return np.array([[0, -half], [radius, -half], [0, half]]), numbers
    if name in ("Capsule", "Capsule_1"):
        low = numbers.get("radiusBottom", radius) * arc[: SEGMENTS // 4 + 1] - (0, half)
        high = numbers.get("radiusTop", radius) * arc[SEGMENTS // 4 :] + (0, half)
        return np.concatenate([low, high]), numbers
    return None, numbers


def _turned_profile(profile: NDArray[np.float64], axis: str) -> Topology:
    """The surface that an outline sweeps around an axis: quads, and fans at the poles."""
    angles = np.arange(SEGMENTS) * (2 * np.pi / SEGMENTS)
    rings = profile[1:-1]
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    side = np.concatenate(
        [rings[:, None, :1] * circle, np.broadcast_to(rings[:, None, 1:], (len(rings), SEGMENTS, 1))], 2
    )
    poles = np.array([[0, 0, profile[0, 1]], [0, 0, profile[-1, 1]]])
    points = np.concatenate([side.reshape(-1, 3), poles]) @ _TURN[axis].T
    here = np.arange(SEGMENTS)
    there = (here + 1) % SEGMENTS
    base = np.arange(len(rings) - 1)[:, None] * SEGMENTS
    quads = np.stack([base + here, base + there, base + SEGMENTS + there, base + SEGMENTS + here], axis=2).reshape(
        -1, 4
    )
    bottom, top, last = len(points) - 2, len(points) - 1, (len(rings) - 1) * SEGMENTS
    caps = np.concatenate([
        np.stack([np.full(SEGMENTS, bottom), there, here], axis=1),
        np.stack([np.full(SEGMENTS, top), last + here, last + there], axis=1),
    ])  # fmt: skip
    corners = np.concatenate([quads.reshape(-1), caps.reshape(-1)])
    sizes = np.repeat([4, 3], [len(quads), len(caps)])
    return Topology(points.astype(np.float32), corners.astype(np.int32), _offsets(sizes))


def _box(name: str, numbers: dict[str, Any]) -> Topology:
    if name == "Plane":
        wide, long = numbers["width"] / 2, numbers["length"] / 2
        flat = np.array([[-wide, -long, 0], [wide, -long, 0], [wide, long, 0], [-wide, long, 0]])
        points = flat @ _TURN[str(numbers["axis"])].T
        return Topology(points.astype(np.float32), np.arange(4, dtype=np.int32), np.array([0, 4], np.int32))
    half = numbers["size"] / 2
    points = np.array([[x, y, z] for x in (-half, half) for y in (-half, half) for z in (-half, half)], np.float32)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Topology(points, np.array(faces, np.int32).reshape(-1), _offsets(np.full(6, 4)))


def _offsets(sizes: NDArray[np.integer]) -> NDArray[np.int32]:
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32)


def _curves(prim: Any) -> Topology:
    points = array(UsdGeom.PointBased(prim).GetPointsAttr(), np.float32, 3)
    sizes = array(UsdGeom.Curves(prim).GetCurveVertexCountsAttr(), np.int64)
    if (sizes < 0).any() or sizes.sum() > len(points):
        sizes = sizes[:0]
    starts = np.arange(max(int(sizes.sum()) - 1, 0))
    inside = ~np.isin(starts + 1, np.cumsum(sizes))
    edges = np.stack([starts, starts + 1], axis=1)[inside].astype(np.int32)
    return Topology(points, *_no_faces(), edges=edges)
