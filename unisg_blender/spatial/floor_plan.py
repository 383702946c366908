"""The outline of a room, from its floor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..geometry.arrays import Floats
from ..geometry.polygon import area, convex_hull, without_straight_corners
from ..scene.categories import FLOOR, has_category
from ..scene.graph import SceneGraph
from ..scene.hierarchy import world_matrices
from ..scene.mesh import Mesh


def floor_row(graph: SceneGraph) -> int:
    """Row of the floor: the entity of category "Floor" with the largest outline.

    Raises
    ------
    UniSGError
        If no entity with a mesh has that category.
    """
    rows = np.flatnonzero(has_category(graph, [FLOOR]) & (graph.mesh >= 0))
    if not len(rows):
        raise UniSGError(f'the scene has no floor: give the object that is the floor the category "{FLOOR}"')
    if len(rows) == 1:
        return int(rows[0])
    world = world_matrices(graph)
    sizes = [abs(area(_outline(graph.meshes[graph.mesh[row]], world[row]))) for row in rows]
    return int(rows[np.argmax(sizes)])


def room_outline(graph: SceneGraph) -> Floats:
    """The outline of the room's floor seen from above, float64 (K, 2), world metres, counter-clockwise.

    Raises
    ------
    UniSGError
        If the scene has no floor.
    """
    row = floor_row(graph)
    return _outline(graph.meshes[graph.mesh[row]], world_matrices(graph)[row])


def mesh_outline(mesh: Mesh) -> Floats:
    """The outline of a floor's mesh in its own frame, float64 (K, 2), counter-clockwise."""
    return _outline(mesh, np.eye(4))


def _outline(mesh: Mesh, matrix: Floats) -> Floats:
    """Largest border of the faces that look up; the convex hull of the points where there is none."""
    points = mesh.points.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    start, stop = mesh.corners, mesh.corners[mesh.following]
    sizes = np.diff(mesh.offsets)
    face = np.repeat(np.arange(len(sizes)), sizes)
    normal = np.zeros((len(sizes), 3))  # twice the area, by Newell's method: faces need not be convex
    np.add.at(normal, face, np.cross(points[start], points[stop]))
    normal *= np.sign(np.linalg.det(matrix[:3, :3]))  # a mirrored floor still looks up
    up = (normal[:, 2] > 0.5 * np.linalg.norm(normal, axis=1))[face]
    places, weld = np.unique(np.round(points[:, :2], 5), axis=0, return_inverse=True)
    weld = weld.reshape(-1)
    loops = _border_loops(np.stack([weld[start[up]], weld[stop[up]]], axis=1))
    if not loops:
        hull = convex_hull(places)
        if len(hull) < 3:
            raise UniSGError('the floor has no area: give the category "Floor" to a surface')
        return hull
    polygons = [without_straight_corners(places[loop]) for loop in loops]
    largest = max(polygons, key=lambda polygon: abs(area(polygon)))
    return largest if area(largest) > 0 else largest[::-1]


def _border_loops(edges: NDArray[np.integer]) -> list[list[int]]:
    """Closed chains of the directed edges (E, 2) that no other face runs along the other way."""
    known = set(map(tuple, edges.tolist()))
    after = {a: b for a, b in sorted(known) if (b, a) not in known and a != b}
    loops = []
    while after:
        loop = [next(iter(after))]
        while loop[-1] in after:
            loop.append(after.pop(loop[-1]))
        if len(loop) > 3 and loop[0] == loop[-1]:
            loops.append(loop[:-1])
    return loops
