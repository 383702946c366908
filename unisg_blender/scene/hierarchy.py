"""Questions about the hierarchy, answered on whole columns."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .graph import SceneGraph
from .parents import subtree_rows


def world_matrices(graph: SceneGraph) -> NDArray[np.float64]:
    """World matrices, float64 (N, 4, 4), read-only: :attr:`.graph.SceneGraph.world`, computed once per scenegraph."""
    return graph.world


def children(graph: SceneGraph, row: int) -> NDArray[np.int64]:
    """Rows of the direct children, in entity order; those of the roots for row -1."""
    return np.flatnonzero(graph.parent == row)


def subtree(graph: SceneGraph, row: int) -> NDArray[np.int64]:
    """Rows of an entity and all its descendants, in entity order."""
    return subtree_rows(graph.parent, row)


def take(graph: SceneGraph, rows: NDArray[np.integer]) -> SceneGraph:
    """The scenegraph of some rows, in the order given (parents must come first).

    An entity whose parent is left out becomes a root where it stands in the
    world; meshes, materials and vocabulary are kept whole.
    """
    rows = np.asarray(rows, np.int64)
    place = np.full(len(graph) + 1, -1, np.int64)  # one more: parent -1 stays -1
    place[rows] = np.arange(len(rows))
    parent = place[graph.parent[rows]]
    local = graph.local[rows].copy()
    cut = (parent < 0) & (graph.parent[rows] >= 0)
    if cut.any():
        local[cut] = graph.world[rows[cut]]
    return graph.replace(
        name=tuple(map(graph.name.__getitem__, rows.tolist())),
        uid=tuple(map(graph.uid.__getitem__, rows.tolist())),
        type=graph.type[rows],
        parent=parent.astype(np.int32),
        category=graph.category[rows],
        local=local,
        mesh=graph.mesh[rows],
        components={
            key: kept for key, value in graph.components.items() if len((kept := value.take(rows, len(graph))).rows)
        },
    )


def local_bounds(graph: SceneGraph) -> NDArray[np.float64]:
    """Boxes of the meshes in their own frames, float64 (N, 2, 3) lowest and highest corner; zeros without a mesh."""
    table = np.zeros((len(graph.meshes) + 1, 2, 3))
    for index, mesh in enumerate(graph.meshes):
        table[index] = mesh.bounds
    return table[graph.mesh]
