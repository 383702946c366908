"""Do objects overlap, and how deep: exact tests between oriented boxes, and the boxes of a mesh's parts."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..geometry.arrays import Floats, Ints
from ..geometry.boxes import Boxes, boxes_around, orthonormal_axes
from ..geometry.grouped_ends import grouped_ends
from ..scene.graph import SceneGraph
from ..scene.hierarchy import world_matrices
from ..scene.mesh import Mesh

PART_LIMIT = 64
"""A mesh with more connected parts than this has them gathered in a 4 x 4 x 4 grid of boxes."""
_parts_of: WeakKeyDictionary[Mesh, Floats] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class PartBoxes:
    """World boxes of all parts of all entities; ``owner`` int64 (P,) is the row that a part belongs to, ascending."""

    boxes: Boxes
    owner: Ints

    def of(self, row: int) -> Boxes:
        """The parts of one entity."""
        return self.boxes.take(np.arange(*np.searchsorted(self.owner, (row, row + 1))))


def mesh_parts(mesh: Mesh) -> Floats:
    """Boxes around the connected parts of a mesh, float64 (K, 2, 3) lowest and highest corner in the mesh's frame.

    Points in the very same place count as one (importers split them at seams), so a
    table of which top and legs are separate shapes has five boxes and a stool finds
    room under it. A mesh without points has none.
    """
    if mesh not in _parts_of:
        _parts_of[mesh] = _find_parts(mesh)
    return _parts_of[mesh]


def connected_parts(mesh: Mesh) -> tuple[Floats, Ints, Ints]:
    """Places (W, 3) of a mesh, each once, the place of each point (V,), and the connected part (W,) of each place."""
    places, weld = np.unique(mesh.points, axis=0, return_inverse=True)
    weld = weld.reshape(-1)
    start = np.concatenate([weld[mesh.corners], weld[mesh.edges[:, 0]]])
    stop = np.concatenate([weld[mesh.corners[mesh.following]], weld[mesh.edges[:, 1]]])
    links = coo_array((np.ones(len(start), bool), (start, stop)), shape=(len(places),) * 2)
    _, part = connected_components(links, directed=False)
    return places.astype(np.float64), weld.astype(np.int64), part.astype(np.int64)


def _find_parts(mesh: Mesh) -> Floats:
    if not np.isfinite(mesh.points).all(axis=1).any():
        return np.zeros((0, 2, 3))
    places, _, part = connected_parts(mesh)
    kept = np.isfinite(places).all(axis=1)
    boxes = _boxes_by_group(places[kept], part[kept])
    if len(boxes) > PART_LIMIT:
        middle = boxes.mean(axis=1)
        span = np.maximum(np.ptp(middle, axis=0), 1e-9)
        cell = np.minimum((4 * (middle - middle.min(axis=0)) / span).astype(np.int64), 3) @ (16, 4, 1)
        boxes = _boxes_by_group(boxes.reshape(-1, 3), np.repeat(cell, 2))
    return boxes


def _boxes_by_group(points: NDArray[np.floating], group: NDArray[np.integer]) -> Floats:
    _, index = np.unique(group, return_inverse=True)
    return np.stack(grouped_ends(index, index.max() + 1, points), axis=1)


def part_boxes(graph: SceneGraph) -> PartBoxes:
    """World boxes of the connected parts of all meshes, in entity order; rows without a mesh have none."""
    parts = [mesh_parts(mesh) for mesh in graph.meshes]
    rows = np.flatnonzero(graph.mesh >= 0)
    counts = np.array([len(parts[index]) for index in graph.mesh[rows]], np.int64)
    owner = np.repeat(rows, counts)
    bounds = np.concatenate([np.zeros((0, 2, 3)), *(parts[index] for index in graph.mesh[rows])])
    world = world_matrices(graph)
    return PartBoxes(boxes_around(bounds, world[owner], orthonormal_axes(world[:, :3, :3])[owner]), owner)
