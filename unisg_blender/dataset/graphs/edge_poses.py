"""How entities lie to each other, beside the edges between them: along the hierarchy, relations, and to the nearest."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...errors import UniSGError
from ...geometry.arrays import Floats, Ints
from ...geometry.rigid_frames import relative_poses
from ...poses import FORMS
from ...scene.parents import compose_world
from ..format.columns import Columns
from ..format.encoding import known_form
from .graph_arrays import EdgeKind, GraphArrays

NEAREST: EdgeKind = ("entity", "nearest", "entity")

STEP = 24_000
"""Edges at a time: their poses stay in the processor's cache."""


@dataclass(frozen=True)
class EdgePoses:
    """What is wanted: ``edge_attr`` with relative poses in a form, and edges to the ``nearest`` others of each entity.

    Attributes
    ----------
    form
        Name in ``FORMS``, one of your own too.
    nearest
        How many edges ``entity - nearest - entity`` begin at each entity that has a mesh; 0 for none.

    Raises
    ------
    UniSGError
        An unknown form, or fewer than no edges.
    """

    form: str = "sixd"
    nearest: int = 0

    def __post_init__(self) -> None:
        known_form(self.form)
        if self.nearest < 0:
            raise UniSGError(f"nearest must be 0 or more, not {self.nearest}")


def with_edge_poses(arrays: GraphArrays, columns: Columns, form: str, wanted: EdgePoses) -> GraphArrays:
    """The graph with edges to the nearest, if any are wanted, and relative poses of all edges between entities.

    A pose is that of the edge's second entity in the frame of its first, float32 (E, width), metres: of world poses
    without their scale. ``columns`` are those that the graph was made of, with poses in ``form`` and the table "world".
    """
    world = _world(columns, form)
    edges, starts = dict(arrays.edges), dict(arrays.edge_ptr)
    if wanted.nearest:
        edges[NEAREST], starts[NEAREST] = _nearest(world, columns, wanted.nearest)
    rigid = FORMS["matrix"].encode(world).reshape(-1, 4, 4)
    between = [kind for kind in edges if kind[0] == kind[2] == "entity"]
    poses = {kind: _encoded(rigid, edges[kind], wanted.form) for kind in between}
    return replace(arrays, edges=edges, edge_ptr=starts, edge_poses=poses)


def _world(columns: Columns, form: str) -> Floats:
    """World matrices (N, 4, 4) of the entities of all scenes; where constraints put them, what hangs under follows."""
    local = np.array(FORMS[form].decode(columns["entity.features"].astype(np.float64), stretch=True))
    first = np.repeat(columns["entity.ptr"][:-1], np.diff(columns["entity.ptr"]))
    parent = np.where(columns["entity.parent"] < 0, -1, columns["entity.parent"] + first)
    moved = columns["world.entity"] + np.repeat(columns["entity.ptr"][:-1], np.diff(columns["world.ptr"]))
    local[moved, :3], parent[moved] = columns["world.matrix"].reshape(-1, 3, 4), -1
    return compose_world(local, parent)


def _encoded(rigid: Floats, pairs: Ints, form: str) -> NDArray[np.float32]:
    found = np.empty((pairs.shape[1], FORMS[form].width), np.float32)
    for start in range(0, len(found), STEP):
        some = slice(start, start + STEP)
        found[some] = FORMS[form].encode(relative_poses(rigid, pairs[:, some].T))
    return found


def _nearest(world: Floats, columns: Columns, count: int) -> tuple[Ints, Ints]:
    """Edges int64 (2, E) from each entity with a mesh to the ``count`` others nearest to it, and where scenes start.

    Near is what has a near middle of its box; the nearest comes first, of those as near the order is the tree's.
    """
    middle = columns["entity.bounds"].reshape(-1, 2, 3).astype(np.float64).mean(axis=1)
    placed = np.einsum("nij,nj->ni", world[:, :3, :3], middle) + world[:, :3, 3]
    shown = columns["entity.mesh"] >= 0
    found, starts = [np.zeros((2, 0), np.int64)], [0]
    for start, stop in zip(columns["entity.ptr"][:-1], columns["entity.ptr"][1:], strict=True):
        rows = start + np.flatnonzero(shown[start:stop])
        found.append(_nearest_of(placed[rows], rows, count))
        starts.append(starts[-1] + found[-1].shape[1])
    return np.concatenate(found, axis=1), np.array(starts, np.int64)


def _nearest_of(places: Floats, rows: Ints, count: int) -> Ints:
    others = min(count, len(rows) - 1)
    if others < 1:
        return np.zeros((2, 0), np.int64)
    near = np.asarray(cKDTree(places).query(places, others + 1)[1])
    own = np.arange(len(rows))[:, None]
    kept = near != own
    kept[kept.all(axis=1), -1] = False  # where more than that many stand in one place it is not among its own nearest
    return np.stack([np.repeat(rows, others), rows[near[kept]]])
