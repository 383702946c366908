"""Rays cast at triangles, one by one and slowly: what another renderer would see."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from unisg_blender.geometry.camera_view import CameraView

Floats = NDArray[np.float64]


def cast(
    view: CameraView, triangles: Floats, owner: NDArray[np.int64], columns: NDArray[np.int64], lines: NDArray[np.int64]
) -> tuple[NDArray[np.int64], Floats]:
    """Whose triangle (M, 3, 3) the rays through the middles of pixels meet first, -1 for none, and its depth (R,)."""
    flat = (np.stack([columns, lines], axis=1) + 0.5 - np.array(view.center)) / view.focal
    turn = np.linalg.inv(view.extrinsics)
    if view.orthographic:
        origin = np.column_stack([flat, np.zeros(len(flat))]) @ turn[:3, :3].T + turn[:3, 3]
        ways = np.broadcast_to(turn[:3, 2], origin.shape)
    else:
        ways = np.column_stack([flat, np.ones(len(flat))]) @ turn[:3, :3].T
        origin = np.broadcast_to(turn[:3, 3], ways.shape)
    who, depth = np.full(len(flat), -1), np.full(len(flat), np.inf)
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    for ray in range(len(flat)):
        across = np.cross(ways[ray], second)
        determinant = np.einsum("ij,ij->i", first, across)
        with np.errstate(divide="ignore", invalid="ignore"):
            away = (origin[ray] - triangles[:, 0]) / determinant[:, None]
            u = np.einsum("ij,ij->i", away, across)
            turned = np.cross(away, first)
            v = turned @ ways[ray]
            far = np.einsum("ij,ij->i", turned, second)
            hit = (np.abs(determinant) > 1e-15) & (u >= 0) & (v >= 0) & (u + v <= 1) & (far > view.clip[0])
        if hit.any():
            nearest = np.argmin(np.where(hit, far, np.inf))
            who[ray], depth[ray] = owner[nearest], far[nearest]
    return who, depth
