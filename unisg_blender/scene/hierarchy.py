"""Questions about the hierarchy, answered on whole columns."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from .component_table import Table, joined, table
from .components import WORLD
from .graph import SceneGraph
from .parents import subtree_rows


def world_matrices(graph: SceneGraph) -> NDArray[np.float64]:
    """World matrices, float64 (N, 4, 4), read-only: :attr:`.graph.SceneGraph.world`, computed once per scenegraph."""
    return graph.world


def local_matrices(graph: SceneGraph, world: NDArray[np.float64]) -> NDArray[np.float64]:
    """Local matrices (N, 4, 4) of world matrices; relative to the world where a parent has no size."""
    parent = np.asarray(graph.parent)
    above = world[np.maximum(parent, 0)]
    x, y, z = (above[:, :3, column] for column in range(3))
    volume = np.einsum("ni,ni->n", x, np.cross(y, z))
    hangs = np.flatnonzero((parent >= 0) & (np.abs(volume) > 1e-12))
    cofactors = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=1)[hangs]
    inverse = cofactors / volume[hangs, None, None]  # by hand: small systems are slow where LAPACK runs in threads
    local = world.copy()
    moved = world[hangs, :3]
    moved[:, :, 3] -= above[hangs, :3, 3]
    local[hangs, :3] = inverse @ moved
    return local


def placed(graph: SceneGraph, rows: Sequence[int], matrices: NDArray[np.float64]) -> SceneGraph:
    """The scenegraph with some entities at world matrices (K, 4, 4), metres; what hangs under them comes along.

    Whatever constraints said of these entities, they are then where they were put.
    """
    free, now = without_world(graph, rows), table(rows, matrix=matrices)
    held = free.components.get(WORLD)
    stage = free.with_component(WORLD, now if held is None else joined([(held, 0), (now, 0)]))
    local = graph.local.copy()
    local[rows] = local_matrices(graph, stage.world)[rows]
    return free.replace(local=local)


def without_world(graph: SceneGraph, rows: Collection[int]) -> SceneGraph:
    """The scene in which these entities are no longer held where constraints put them."""
    held = graph.components.get(WORLD)
    if held is None:
        return graph
    kept = np.flatnonzero(~np.isin(held.rows, list(rows)))
    columns = {key: value[kept] for key, value in held.columns.items()}
    return graph.with_component(WORLD, Table(held.rows[kept], columns))


def children(graph: SceneGraph, row: int) -> NDArray[np.int64]:
    """Rows (K,) of the direct children, in entity order; those of the roots for row -1."""
    return np.flatnonzero(graph.parent == row)


def subtree(graph: SceneGraph, row: int) -> NDArray[np.int64]:
    """Rows (K,) of an entity and all its descendants, in entity order."""
    return subtree_rows(graph.parent, row)


def take(graph: SceneGraph, rows: NDArray[np.integer]) -> SceneGraph:
    """The scenegraph of some rows (K,), in the order given (parents must come first).

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
