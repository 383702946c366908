"""The objects of a scene: what relations are told of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry.boxes import Boxes, orthonormal_axes
from ..scene.graph import SceneGraph
from ..scene.hierarchy import world_matrices


@dataclass(frozen=True, eq=False)
class RelationObjects:
    """Entities with meshes of their own or of uncategorised entities below them.

    ``rows`` int64 (T,); ``of_row`` int64 (N,): the object that a row's mesh belongs to,
    -1 for none; ``meshes``: rows of the meshes of each object; ``low``, ``high`` (T, 3): exact
    axis-aligned boxes in the world; ``axes`` (T, 3, 3): their own axes; ``parts``: (row, row of
    the object) of meshes that only belong to an object; ``above`` int64 (T,): the next object up the
    hierarchy, -1 for none.
    """

    rows: NDArray[np.int64]
    of_row: NDArray[np.int64]
    meshes: list[NDArray[np.int64]]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    axes: NDArray[np.float64]
    parts: list[tuple[int, int]]
    above: NDArray[np.int64]

    @property
    def boxes(self) -> Boxes:
        """The axis-aligned boxes."""
        count = len(self.rows)
        eyes = np.broadcast_to(np.eye(3), (count, 3, 3))
        return Boxes((self.low + self.high) / 2, eyes, (self.high - self.low) / 2, np.ones(count, bool))

    def is_below(self, one: int, two: int) -> bool:
        """True if object ``one`` hangs under object ``two`` in the hierarchy."""
        place = int(self.above[one])
        while place >= 0 and place != two:
            place = int(self.above[place])
        return place == two


def find_relation_objects(graph: SceneGraph) -> RelationObjects:
    """Group the meshes of a scene into objects.

    A mesh belongs to the nearest entity at or above it that has a category; without
    one it is an object by itself.
    """
    named = np.where(graph.category >= 0, np.arange(len(graph)), -1)
    for row, above in enumerate(graph.parent.tolist()):  # parents come first
        if named[row] < 0 <= above:
            named[row] = named[above]
    shown = np.array([len(mesh.points) > 0 for mesh in graph.meshes] + [False], bool)[graph.mesh]
    owner = np.where(shown, np.where(named >= 0, named, np.arange(len(graph))), -1)
    rows = np.unique(owner[owner >= 0])
    of_row = np.full(len(graph) + 1, -1, np.int64)
    of_row[rows] = np.arange(len(rows))
    of_row = np.where(owner >= 0, of_row[owner], -1)
    low, high = _world_bounds(graph, shown)
    lowest, highest = np.full((len(rows), 3), np.inf), np.full((len(rows), 3), -np.inf)
    np.minimum.at(lowest, of_row[shown], low[shown])
    np.maximum.at(highest, of_row[shown], high[shown])
    by_object = np.flatnonzero(shown)[np.argsort(of_row[shown], kind="stable")]
    meshes = np.split(by_object, np.cumsum(np.bincount(of_row[shown], minlength=len(rows)))[:-1])
    parts = [(int(row), int(owner[row])) for row in np.flatnonzero(shown & (owner != np.arange(len(graph))))]
    axes = orthonormal_axes(world_matrices(graph)[rows, :3, :3])
    return RelationObjects(rows, of_row, meshes if len(rows) else [], lowest, highest, axes, parts, _above(graph, rows))


def _world_bounds(graph: SceneGraph, shown: NDArray[np.bool_]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    world = world_matrices(graph)
    low, high = np.zeros((len(graph), 3)), np.zeros((len(graph), 3))
    for row in np.flatnonzero(shown):
        points = graph.meshes[graph.mesh[row]].points @ world[row, :3, :3].T + world[row, :3, 3]
        points = points[np.isfinite(points).all(axis=1)]
        if len(points):
            low[row], high[row] = points.min(axis=0), points.max(axis=0)
        else:
            low[row] = high[row] = world[row, :3, 3]
    return low, high


def _above(graph: SceneGraph, rows: NDArray[np.int64]) -> NDArray[np.int64]:
    place = np.full(len(graph), -1, np.int64)
    place[rows] = np.arange(len(rows))
    nearest = np.full(len(graph) + 1, -1, np.int64)  # one more: the parent of roots
    for row, above in enumerate(graph.parent.tolist()):
        nearest[row] = place[above] if above >= 0 and place[above] >= 0 else nearest[above]
    return nearest[rows]
