"""Scenes as one heterogeneous graph, in plain arrays: nodes by type, edges by kind, and where each scene starts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..format.behaviour_rows import LINKS
from ..format.columns import Columns

EdgeKind = tuple[str, str, str]
RESERVED = ("parent_of", "has", "nearest")


@dataclass(frozen=True, eq=False)
class GraphArrays:
    """B scenes as one graph.

    ``nodes[type][attribute]`` has one row per node; ``edges[kind]`` is int64 (2, E),
    source row over destination row, counted over all scenes; ``node_ptr[type]`` and
    ``edge_ptr[kind]``, int64 (B + 1,), say where each scene starts; ``label``
    int64 (B,) is the kind of scene, -1 for none; ``edge_poses[kind]`` (E, width) are relative poses, if wanted.
    """

    nodes: dict[str, dict[str, NDArray]]
    edges: dict[EdgeKind, NDArray[np.int64]]
    node_ptr: dict[str, NDArray[np.int64]]
    edge_ptr: dict[EdgeKind, NDArray[np.int64]]
    label: NDArray[np.int64]
    edge_poses: dict[EdgeKind, NDArray[np.float32]] = field(default_factory=dict)


def graph_arrays(columns: Columns, relations: Sequence[str]) -> GraphArrays:
    """Nodes and edges of the scenes in some columns; ``relations`` names the kinds of relation (edges each).

    Node types are entity, info, trs, mesh, action, lesson and stage. Every scene
    has a mesh node for each mesh that it uses, however many entities share it.
    """
    ptr = {table: columns[f"{table}.ptr"] for table in ("entity", "action", "lesson", "stage", "relation", "link")}
    count = len(ptr["entity"]) - 1
    owner = np.repeat(np.arange(count), np.diff(ptr["entity"]))
    mesh_rows, mesh_ptr, mesh_edges = _mesh_nodes(columns["entity.mesh"], owner, count)
    every = np.arange(len(owner))
    below = np.flatnonzero(columns["entity.parent"] >= 0)
    above = columns["entity.parent"][below] + ptr["entity"][owner[below]]
    actor = columns["action.entity"] + np.repeat(ptr["entity"][:-1], np.diff(ptr["action"]))
    edges = {
        ("entity", "parent_of", "entity"): np.stack([above, below]),
        ("entity", "has", "info"): np.stack([every, every]),
        ("entity", "has", "trs"): np.stack([every, every]),
        ("entity", "has", "mesh"): mesh_edges,
        ("entity", "has", "action"): np.stack([actor, np.arange(len(actor))]),
    }
    starts = {
        ("entity", "parent_of", "entity"): np.searchsorted(below, ptr["entity"]),
        ("entity", "has", "info"): ptr["entity"],
        ("entity", "has", "trs"): ptr["entity"],
        ("entity", "has", "mesh"): np.searchsorted(mesh_edges[0], ptr["entity"]),
        ("entity", "has", "action"): ptr["action"],
    }
    related = [("entity", f"related_{name}" if name in RESERVED else name, "entity") for name in relations]
    _split_edges(columns, "relation", "subject", related, ptr, edges, starts)
    _split_edges(columns, "link", "source", LINKS, ptr, edges, starts)
    info = _info(columns, np.bincount(above, minlength=len(owner)), np.bincount(actor, minlength=len(owner)))
    nodes = {
        "entity": {
            "x": columns["entity.bounds"].reshape(-1, 6),
            "category": columns["entity.category"].astype(np.int64),
            "type": columns["entity.type"].astype(np.int64),
        },
        "info": {"x": info},
        "trs": {"x": columns["entity.features"]},
        "mesh": {"x": columns["mesh.descriptor"][mesh_rows]},
        "action": {"x": columns["action.vector"], "mask": columns["action.mask"]},
        "lesson": {"x": columns["lesson.vector"]},
        "stage": {"x": columns["stage.vector"]},
    }
    if columns["mesh.feature"].shape[1]:
        nodes["mesh"]["feature"] = columns["mesh.feature"][mesh_rows]
    node_ptr = {kind: ptr[kind if kind in ptr else "entity"] for kind in nodes} | {"mesh": mesh_ptr}
    return GraphArrays(nodes, edges, node_ptr, starts, columns["scene.label"].astype(np.int64))


def _mesh_nodes(
    mesh: NDArray[np.int32], owner: NDArray[np.int64], count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Rows of the mesh table by node, where each scene's nodes start, and entity-to-node edges."""
    shown = np.flatnonzero(mesh >= 0)
    keys, place = np.unique(owner[shown] << 32 | mesh[shown], return_inverse=True)
    return keys & 0xFFFFFFFF, np.searchsorted(keys >> 32, np.arange(count + 1)), np.stack([shown, place])


def _info(columns: Columns, children: NDArray[np.int64], actions: NDArray[np.int64]) -> NDArray[np.float32]:
    """The info component, float32 (N, 4): entities, TRS, meshes and actions directly under each entity."""
    ones = np.ones(len(children))
    return np.stack([children, ones, columns["entity.mesh"] >= 0, actions], axis=1).astype(np.float32)


def _split_edges(
    columns: Columns,
    table: str,
    source: str,
    kinds: Sequence[EdgeKind],
    ptr: dict[str, NDArray[np.int64]],
    edges: dict[EdgeKind, NDArray[np.int64]],
    starts: dict[EdgeKind, NDArray[np.int64]],
) -> None:
    """Sort the rows of an edge table into one edge list per kind, counted over all scenes."""
    scene = np.repeat(np.arange(len(ptr[table]) - 1), np.diff(ptr[table]))
    kind = columns[f"{table}.kind"]
    for number, (start, _, stop) in enumerate(kinds):
        rows = np.flatnonzero(kind == number)
        ends = (columns[f"{table}.{source}"][rows], columns[f"{table}.target"][rows])
        shift = (ptr[start][scene[rows]], ptr[stop][scene[rows]])
        edges[kinds[number]] = np.stack([ends[0] + shift[0], ends[1] + shift[1]])
        starts[kinds[number]] = np.searchsorted(rows, ptr[table])
