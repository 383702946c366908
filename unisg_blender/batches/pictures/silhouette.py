"""What an object would cover of a picture if nothing were before it, also beyond the picture's edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...geometry.camera_view import CameraView

GRID = 32
"""Points at which a silhouette is looked at along its longer side; a smaller one at all its pixels."""

AT_ONCE = 2**20


@dataclass(frozen=True)
class Silhouette:
    """The ``area`` in pixels of an object alone, the box around it (x, y, width, height) in pixels, which may go beyond
    the picture, and whether a part of it is beyond."""

    area: float
    box: tuple[float, float, float, float]
    truncated: bool


def silhouette(view: CameraView, triangles: Floats) -> Silhouette | None:
    """That of the triangles (M, 3, 3) of an object, metres in the world; None if a part of it is behind the camera."""
    pixels, depth = view.project(triangles.reshape(-1, 3))
    if (depth <= view.clip[0]).any():
        return None
    flat = pixels.reshape(-1, 3, 2)
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    size = np.array(view.size)
    step = max(1, int(np.ceil((high - low).max() / GRID)))
    start = np.floor(low)
    columns, lines = (np.arange(start[axis] + step / 2, high[axis] + step / 2, step) for axis in (0, 1))
    points = np.stack(np.meshgrid(columns, lines), axis=-1).reshape(-1, 2)
    area = float(_covered(points, flat).sum()) * step * step
    truncated = bool((low < -0.5).any() or (high > size + 0.5).any())
    box = (float(low[0]), float(low[1]), float(high[0] - low[0]), float(high[1] - low[1]))
    return Silhouette(area, box, truncated)


def _covered(points: Floats, triangles: Floats) -> Bools:
    """Which points (P, 2) are in any of some triangles (M, 3, 2), whichever way round these are."""
    found = np.zeros(len(points), bool)
    for part in np.array_split(triangles, max(1, len(triangles) * len(points) // AT_ONCE)):
        left = np.flatnonzero(~found)
        low, high = part.min(axis=(0, 1)), part.max(axis=(0, 1))
        left = left[((points[left] >= low) & (points[left] <= high)).all(axis=1)]
        edge = np.roll(part, -1, axis=1) - part
        to = points[left][:, None, None] - part
        side = edge[..., 0] * to[..., 1] - edge[..., 1] * to[..., 0]
        within = ((side >= 0).all(axis=2) | (side <= 0).all(axis=2)).any(axis=1)
        found[left[within]] = True
    return found
