"""Things that are modelled in parts, put together: an empty over a table's top and legs is one table."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from scipy.sparse.csgraph import connected_components

from ..geometry.arrays import Floats, Ints
from ..scene import Mesh, SceneGraph, subtree
from ..spatial.object_rows import shown
from ..words import thing_table

TOUCHING = 0.03
"""Metres between the boxes of parts that belong together, at most."""

LARGEST, MOST_PARTS = 3.5, 500
"""Metres and meshes of a thing at most: larger groups are rooms."""


def things_as_one(graph: SceneGraph, built: Collection[int] = ()) -> SceneGraph:
    """The scene in which an entity without a mesh that stands for one thing has the mesh of all its parts.

    It does if the meshes under it, of which none is ``built``, has a category or the name of another thing, touch each
    other and make something no larger than :data:`LARGEST` metres. The parts then have no mesh. Copies share one.
    """
    solid = shown(graph)
    mesh, meshes = graph.mesh.copy(), list(graph.meshes)
    known: dict[tuple[object, ...], int] = {}
    for row in np.flatnonzero((graph.mesh < 0) & (graph.category < 0)).tolist():  # parents come first
        below = subtree(graph, row)[1:]
        parts = below[solid[below] & (mesh[below] >= 0)]
        alone = (graph.category[below] < 0).all() and not np.isin(parts, list(built)).any()
        if not (2 <= len(parts) <= MOST_PARTS and alone and _are_one(graph, row, parts)):
            continue
        poses = np.linalg.pinv(graph.world[row]) @ graph.world[parts]
        key = (*graph.mesh[parts].tolist(), (np.round(poses, 4) + 0.0).tobytes())
        if key not in known:
            meshes.append(_joined(graph, row, parts, poses))
            known[key] = len(meshes) - 1
        mesh[row], mesh[parts] = known[key], -1
    return graph.replace(mesh=mesh, meshes=tuple(meshes)) if known else graph


def _are_one(graph: SceneGraph, row: int, parts: Ints) -> bool:
    own = thing_table().read(graph.name[row]).thing
    named = [thing_table().read(graph.name[part]) for part in parts]
    if any(name.thing not in ("", own) and not name.part for name in named):
        return False
    if sum(name.thing == own != "" and not name.part for name in named) > 1:
        return False  # several of the same: chairs
    boxes = [_bounds(graph, part) for part in parts]
    low, high = np.array([box[0] for box in boxes]), np.array([box[1] for box in boxes])
    if not np.isfinite(low).all() or (high.max(axis=0) - low.min(axis=0)).max() > LARGEST:
        return False
    near = ((low[:, None] <= high + TOUCHING) & (high[:, None] >= low - TOUCHING)).all(axis=2)
    return bool(connected_components(near, directed=False, return_labels=False) == 1)


def _bounds(graph: SceneGraph, row: int) -> tuple[Floats, Floats]:
    points = graph.meshes[graph.mesh[row]].points @ graph.world[row, :3, :3].T + graph.world[row, :3, 3]
    return points.min(axis=0), points.max(axis=0)


def _joined(graph: SceneGraph, row: int, parts: Ints, poses: Floats) -> Mesh:
    """The meshes of some rows as one, in the frame of another, in which they have ``poses`` (P, 4, 4)."""
    own = [graph.meshes[graph.mesh[part]] for part in parts]
    first = np.cumsum([0, *(len(mesh.points) for mesh in own)])
    placed = [mesh.points @ pose[:3, :3].T + pose[:3, 3] for mesh, pose in zip(own, poses, strict=True)]
    corners = np.concatenate([mesh.corners + start for mesh, start in zip(own, first, strict=False)])
    offsets = np.concatenate([[0], np.cumsum(np.concatenate([np.diff(mesh.offsets) for mesh in own]))])
    points = np.concatenate(placed).astype(np.float32)
    return Mesh(graph.name[row], points, corners.astype(np.int32), offsets.astype(np.int32))
