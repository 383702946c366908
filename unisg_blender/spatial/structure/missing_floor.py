"""Walls without a floor, as rooms for robots have them: the ground is in the simulator there, not in the file."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Floats
from ...geometry.corner_ends import corner_ends
from ...geometry.grouped_ends import grouped_ends
from ...scene.builder import SceneBuilder
from ...scene.categories import FLOOR
from ...scene.graph import SceneGraph
from ...scene.merge import append
from ...scene.mesh import Mesh
from .recognise import UPRIGHT, recognise_structure
from .scan import HEADROOM, LEVEL, Scan

LONG = 2.5
"""Metres of the longer side of what may be a wall, at least."""


def missing_floor(graph: SceneGraph) -> Floats | None:
    """Where a floor would make rooms of walls that stand in a scene without one.

    Returns
    -------
    Array or None
        The lowest and highest corner (2, 3) of a level rectangle under all walls, metres; None where there is a floor,
        or where such a rectangle makes no room. It is at height 0, where simulators have the ground, if the walls
        begin near that, else at their feet.
    """
    if recognise_structure(graph).rooms or (scan := Scan.of(graph)) is None:
        return None
    upright = (np.abs(scan.slope) < UPRIGHT) & scan.building
    if not upright.any():
        return None
    rows, place = np.unique(scan.row[upright], return_inverse=True)
    corners = scan.triangles[upright]
    low, high = grouped_ends(place, len(rows), *corner_ends(corners))
    walls = (np.ptp([low[:, 2], high[:, 2]], axis=0) >= HEADROOM) & ((high - low)[:, :2].max(axis=1) >= LONG)
    if not walls.any():
        return None
    foot = float(low[walls, 2].min())
    ends = np.stack([low[walls].min(axis=0), high[walls].max(axis=0)])
    ends[:, 2] = 0.0 if abs(foot) <= LEVEL else foot
    rooms = recognise_structure(append(graph, [floor_plane(ends)], [""])).rooms
    return ends if any(room.indoors for room in rooms) else None


def floor_plane(ends: Floats) -> SceneGraph:
    """A floor, a level rectangle between two corners (2, 3), as a scene of its own; its origin is its middle."""
    x, y, _ = np.ptp(ends, axis=0) / 2
    points = np.array([(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)], np.float32)
    mesh = Mesh(FLOOR, points, np.arange(4, dtype=np.int32), np.array([0, 4], np.int32))
    scene, local = SceneBuilder(), np.eye(4)
    local[:3, 3] = ends.mean(axis=0)
    scene.add(FLOOR, uid=FLOOR, local=local, mesh=mesh, category=FLOOR)
    return scene.build()
