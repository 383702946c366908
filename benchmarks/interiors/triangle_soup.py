"""Triangles of a scene with trees of Blender's mathutils over them, for the judge of what was placed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import bpy  # noqa: F401  it brings mathutils
import numpy as np
from mathutils.bvhtree import BVHTree

from unisg_blender.scene import SceneGraph


@dataclass(frozen=True, eq=False)
class Soup:
    """Triangles (M, 3, 3) in world metres, and the row (M,) of each."""

    triangles: Any
    row: Any

    @staticmethod
    def of(graph: SceneGraph, rows: Sequence[int]) -> Soup:
        """The meshes of some rows."""
        parts, numbers = [np.zeros((0, 3, 3))], [np.zeros(0, int)]
        for row in rows:
            if graph.mesh[row] >= 0:
                mesh, matrix = graph.meshes[graph.mesh[row]], np.asarray(graph.world[row])
                points = np.asarray(mesh.points, float) @ matrix[:3, :3].T + matrix[:3, 3]
                parts.append(points[np.asarray(mesh.triangles)])
                numbers.append(np.full(len(parts[-1]), row))
        triangles, row = np.concatenate(parts), np.concatenate(numbers)
        sound = np.isfinite(triangles).all(axis=(1, 2))
        return Soup(triangles[sound], row[sound])

    def near(self, low: Any, high: Any) -> Soup:
        """Those whose boxes meet a box."""
        hit = (self.triangles.min(axis=1) <= high).all(axis=1) & (self.triangles.max(axis=1) >= low).all(axis=1)
        return Soup(self.triangles[hit], self.row[hit])

    @cached_property
    def tree(self) -> BVHTree:
        """For rays and overlaps."""
        return tree_of(self.triangles)


def tree_of(triangles: Any) -> BVHTree:
    """A tree of triangles (M, 3, 3)."""
    corners = triangles.reshape(-1, 3)
    return BVHTree.FromPolygons(corners.tolist(), np.arange(len(corners)).reshape(-1, 3).tolist(), epsilon=0.0)


def sampled(triangles: Any, step: float) -> list[Any]:
    """Points on triangles, not farther than a step apart, in handfuls."""
    if not len(triangles):
        return []
    longest = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
    parts = np.ceil(longest / step).astype(int).clip(1)
    found = []
    for count in np.unique(parts):
        own = triangles[parts == count]
        i, j = (side.ravel() for side in np.mgrid[0 : count + 1, 0 : count + 1])
        keep = i + j <= count
        share = np.stack([i[keep], j[keep], count - i[keep] - j[keep]], axis=1) / count
        for start in range(0, len(own), max(1, 2_000_000 // len(share))):
            some = own[start : start + max(1, 2_000_000 // len(share))]
            found.append(np.einsum("sk,mkd->msd", share, some).reshape(-1, 3))
    return found
