"""Questions about the hierarchy, answered on whole columns."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .graph import SceneGraph
from .order import depths


def compose_world(local: NDArray[np.float64], parent: NDArray[np.integer]) -> NDArray[np.float64]:
    """World matrices (N, 4, 4) from child-to-parent ones, one product per level of the hierarchy."""
    world = np.array(local, np.float64)
    depth = depths(parent)
    if not depth.any():
        return world
    by_level = np.argsort(depth, kind="stable")
    ends = np.searchsorted(depth[by_level], np.arange(1, depth.max(initial=0) + 2))
    for start, stop in pairwise(ends):
        rows = by_level[start:stop]
        world[rows] = world[parent[rows]] @ local[rows]
    return world


def world_matrices(graph: SceneGraph) -> NDArray[np.float64]:
    """World matrices, float64 (N, 4, 4), column vectors, metres.

    Entities that constraints move have their evaluated matrix, and what hangs
    under them follows.
    """
    moved = graph.components.get("world")
    if moved is None:
        return compose_world(graph.local, graph.parent)
    local, parent = graph.local.copy(), graph.parent.copy()
    local[moved.rows], parent[moved.rows] = moved.columns["matrix"], -1
    return compose_world(local, parent)


def children(graph: SceneGraph, row: int) -> NDArray[np.int64]:
    """Rows of the direct children, in entity order; those of the roots for row -1."""
    return np.flatnonzero(graph.parent == row)


def subtree(graph: SceneGraph, row: int) -> NDArray[np.int64]:
    """Rows of an entity and all its descendants, in entity order."""
    inside = np.zeros(len(graph), bool)
    level = np.array([row])
    while len(level):
        inside[level] = True
        level = np.flatnonzero(np.isin(graph.parent, level))
    return np.flatnonzero(inside)


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
        local[cut] = world_matrices(graph)[rows[cut]]
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
