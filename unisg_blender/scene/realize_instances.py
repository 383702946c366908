"""Instances as entities, for those who need every copy to be one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .action_data import ActionData
from .assembly import canonical
from .components import ACTIONS, INSTANCES, RELATIONS, WORLD
from .graph import SceneGraph, Table, table
from .hierarchy import world_matrices
from .identity import derived_uid, retarget_copy


def realize(graph: SceneGraph) -> SceneGraph:
    """The scenegraph with every instance, also those inside prototypes, as entities under the one that has it.

    A copy's uid is derived from the uids of its original and of the entity that
    has it, and from its number there, so the same scene always gives the same uids;
    actions and relations inside a copy point to the copies.
    """
    found = graph.components.get(INSTANCES)
    if found is None:
        return graph
    realized: dict[int, SceneGraph] = {}
    copies = []
    world = world_matrices(graph)
    bare = graph.with_component(INSTANCES, Table(np.zeros(0, np.int32), {}))
    for number, row in enumerate(found.rows.tolist()):
        prototype = found.columns["prototype"][number]
        if id(prototype) not in realized:
            realized[id(prototype)] = realize(prototype)
        matrix = found.columns["matrix"][number]
        copies.append(_copy(realized[id(prototype)], f"{graph.uid[row]} {number}", row, matrix, world[row] @ matrix))
    return canonical(_joined(bare, copies))


def _copy(
    prototype: SceneGraph, owner: str, row: int, matrix: NDArray[np.float64], world: NDArray[np.float64]
) -> SceneGraph:
    """A prototype with uids of its own; its roots stand at ``matrix`` under ``row`` of the scene it goes to.

    ``parent`` then holds rows of that scene for the roots, coded as -2 - row.
    """
    uids = tuple(derived_uid(uid, owner) for uid in prototype.uid)
    copy_of = dict(zip(prototype.uid, uids, strict=True))
    roots = prototype.parent < 0
    local = prototype.local.copy()
    local[roots] = matrix @ local[roots]
    components = dict(prototype.components)
    if WORLD in components:
        moved = components[WORLD]
        components[WORLD] = Table(moved.rows, {"matrix": world @ moved.columns["matrix"]})
    if RELATIONS in components:
        columns = dict(components[RELATIONS].columns)
        columns["target"] = _objects([copy_of.get(uid, uid) for uid in columns["target"]])
        components[RELATIONS] = Table(components[RELATIONS].rows, columns)
    if ACTIONS in components:
        components[ACTIONS] = _retargeted(components[ACTIONS], uids, copy_of)
    parent = np.where(roots, -2 - row, prototype.parent)
    return prototype.replace(uid=uids, local=local, parent=parent, components=components)


def _retargeted(actions: Table, uids: Sequence[str], copy_of: Mapping[str, str]) -> Table:
    owners = [uids[row] for row in actions.rows]
    data: list[ActionData] = list(actions.columns["data"])
    moved = dict(copy_of) | {
        action.uid: derived_uid(action.uid, owner) for action, owner in zip(data, owners, strict=True)
    }
    return Table(
        actions.rows,
        {"data": _objects([retarget_copy(action, owner, moved) for action, owner in zip(data, owners, strict=True)])},
    )


def _objects(values: Sequence[Any]) -> NDArray[Any]:
    column = np.empty(len(values), object)
    column[:] = values
    return column


def _joined(graph: SceneGraph, copies: Sequence[SceneGraph]) -> SceneGraph:
    """One scenegraph out of several; parents of ``copies`` are coded as by :func:`_copy`."""
    parts = [graph, *copies]
    starts = np.cumsum([0, *map(len, parts)])
    meshes = {id(mesh): mesh for part in parts for mesh in part.meshes}
    place = {key: index for index, key in enumerate(meshes)}
    vocabulary = tuple(sorted({name for part in parts for name in part.vocabulary}))
    return SceneGraph(
        name=tuple(name for part in parts for name in part.name),
        uid=tuple(uid for part in parts for uid in part.uid),
        type=np.concatenate([part.type for part in parts]),
        parent=np.concatenate(
            [
                np.where(part.parent >= 0, part.parent + start, np.where(part.parent < -1, -2 - part.parent, -1))
                for part, start in zip(parts, starts[:-1], strict=True)
            ]
        ).astype(np.int32),
        category=np.concatenate(
            [_renumbered(part.category, [vocabulary.index(name) for name in part.vocabulary]) for part in parts]
        ),
        vocabulary=vocabulary,
        local=np.concatenate([part.local for part in parts]),
        mesh=np.concatenate([_renumbered(part.mesh, [place[id(mesh)] for mesh in part.meshes]) for part in parts]),
        meshes=tuple(meshes.values()),
        materials={name: material for part in reversed(parts) for name, material in part.materials.items()},
        components=_joined_tables([part.components for part in parts], starts),
        title=graph.title,
    )


def _renumbered(column: NDArray[np.int32], places: Sequence[int]) -> NDArray[np.int32]:
    return np.array([*places, -1], np.int32)[column]  # -1, for none, takes the last place


def _joined_tables(parts: Sequence[Mapping[str, Table]], starts: NDArray[np.int64]) -> dict[str, Table]:
    joined = {}
    for name in dict.fromkeys(name for part in parts for name in part):
        found = [(part[name], start) for part, start in zip(parts, starts, strict=False) if name in part]
        rows = np.concatenate([one.rows + start for one, start in found])
        keys = found[0][0].columns
        joined[name] = table(rows, **{key: np.concatenate([one.columns[key] for one, _ in found]) for key in keys})
    return joined
