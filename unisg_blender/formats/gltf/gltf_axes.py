"""How glTF says where a node stands in its parent: in parts, or where that cannot be as a matrix."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.affine_rows import rotation_and_size
from ...poses.rotations import quaternion_from_rotation

STRAIGHT = 1e-9
"""How far a matrix may be from its translation, rotation and scale, relative to its largest number."""

DOWN = [-np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]
"""Quaternion x, y, z, w: what looks along -z in our frame of an entity, such as a camera, in glTF's frame of it."""


def placements(matrices: NDArray[np.float64]) -> list[dict[str, Any]]:
    """How glTF says affine matrices (K, 4, 4) of its own frame: in parts, or as a matrix where there is shear.

    Only what has parts can be moved by an animation or a behaviour graph.
    """
    translation, rotation, scale, straight = parts_of(matrices)
    return [
        _parts(translation[k], rotation[k], scale[k]) if straight[k] else {"matrix": matrices[k].T.ravel().tolist()}
        for k in range(len(matrices))
    ]


def parts_of(matrices: NDArray[np.float64]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[np.bool_]]:
    """Translation (K, 3), rotation (K, 4) as x, y, z, w, scale (K, 3), and whether these are the matrix (K,)."""
    rows = np.ascontiguousarray(matrices[:, :3].reshape(-1, 12).T)
    columns, size, _ = rotation_and_size(rows)
    turn = columns.reshape(3, 3, -1).transpose(2, 1, 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        sign = np.where(np.linalg.det(matrices[:, :3, :3]) < 0, -1.0, 1.0)
        scale = size.T * sign[:, None]
        quaternion = np.stack(quaternion_from_rotation(tuple(turn.reshape(-1, 9).T)), axis=1)
        error = np.abs(turn * scale[:, None] - matrices[:, :3, :3]).max(axis=(1, 2))
        straight = error <= STRAIGHT * np.abs(matrices[:, :3, :3]).max(axis=(1, 2))
        straight &= np.abs(np.linalg.norm(quaternion, axis=1) - 1) < STRAIGHT
    return matrices[:, :3, 3], quaternion[:, [1, 2, 3, 0]], scale, straight


def _parts(translation: NDArray[Any], rotation: NDArray[Any], scale: NDArray[Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if translation.any():
        found["translation"] = translation.tolist()
    if (rotation != [0, 0, 0, 1]).any():
        found["rotation"] = rotation.tolist()
    if np.abs(scale - 1).max() > STRAIGHT:
        found["scale"] = scale.tolist()
    return found
