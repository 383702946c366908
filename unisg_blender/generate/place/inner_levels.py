"""What is level within a thing, such as the bottom of a bucket: boxes of parts tell only its upper side."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Floats
from ...scene.mesh import Mesh
from ...spatial.supports import CONTACT

LEVEL, SAME = 0.999, 1e-4
"""The upward part of the normal of what is level; metres within which two heights are one."""


def inner_levels(mesh: Mesh, world: Floats) -> Floats:
    """Heights (L,), ascending, of the faces of a mesh that are level and look up, metres in the world."""
    corners = (mesh.points.astype(np.float64) @ world[:3, :3].T + world[:3, 3])[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    level = normal[:, 2] > LEVEL * np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    found = np.unique((corners[level, :, 2].mean(axis=1) / SAME).round() * SAME)
    return np.asarray(found, np.float64)


def onto_level(heights: Floats, levels: Floats) -> Floats:
    """Heights (T,) raised to the highest of some levels (L,) that is no farther above than what counts as contact."""
    step = levels - heights[:, None]
    near = (step > SAME) & (step <= CONTACT)
    return np.where(near.any(axis=1), np.where(near, levels, -np.inf).max(axis=1), heights)
