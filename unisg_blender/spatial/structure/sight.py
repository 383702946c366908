"""From which side things in a room are seen best."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...geometry.corner_ends import corner_ends, meeting_ends
from ...geometry.triangle_crossings import crossings
from ...scene.graph import SceneGraph
from .scan import world_triangles

FAR, BEFORE = 30.0, 0.05
"""Metres of a line of sight, and from the point on that are free."""


def best_seen(
    graph: SceneGraph, points: Floats, ways: Sequence[Floats], left_out: Callable[[Floats, Floats], Bools]
) -> int:
    """Along which of some ways of looking (3,) most points (K, 3) are seen, the first of the best.

    ``left_out`` says which faces, by their middles (M, 3), are left out of a picture along a way; metres.
    """
    triangles, _ = world_triangles(graph)
    low, high = points.min(axis=0) - FAR, points.max(axis=0) + FAR
    near = meeting_ends(*corner_ends(triangles), low, high)
    triangles = triangles[near]
    middles = triangles.mean(axis=1)
    seen = []
    for way in ways:
        back = -way / np.linalg.norm(way)
        lines = np.stack([points + BEFORE * back, points + FAR * back], axis=1)
        hidden = np.unique(crossings(lines, triangles[~left_out(middles, way)])[0])
        seen.append(len(points) - len(hidden))
    return int(np.argmax(seen))
