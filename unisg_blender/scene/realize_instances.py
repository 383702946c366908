"""Instances as entities, for those who need every copy to be one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from .action_data import ActionData
from .component_table import Table, table
from .components import ACTIONS, INSTANCES, RELATIONS, WORLD
from .graph import SceneGraph
from .identity import derived_uid, retarget_copy
from .merge import append

MOST_ENTITIES = 1_000_000


def realize(graph: SceneGraph) -> SceneGraph:
    """The scenegraph with every instance, also those inside prototypes, as entities under the one that has it.

    A copy's uid is derived from the uids of its original and of the entity that
    has it, and from its number there, so the same scene always gives the same uids;
    actions and relations inside a copy point to the copies.

    Raises
    ------
    UniSGError
        If there would be more than :data:`MOST_ENTITIES`.
    """
    found = graph.components.get(INSTANCES)
    if found is None:
        return graph
    count = count_copies(graph)
    if count > MOST_ENTITIES:
        raise UniSGError(f"its instances would be {count:,} entities, more than {MOST_ENTITIES:,}: keep them instances")
    realized: dict[int, SceneGraph] = {}
    copies, owners = [], [graph.uid[row] for row in found.rows]
    bare = graph.with_component(INSTANCES, Table(np.zeros(0, np.int32), {}))
    for number, row in enumerate(found.rows.tolist()):
        prototype = found.columns["prototype"][number]
        if id(prototype) not in realized:
            realized[id(prototype)] = realize(prototype)
        matrix = found.columns["matrix"][number]
        owner = f"{owners[number]} {number}"
        copies.append(_copy(realized[id(prototype)], owner, matrix, graph.world[row] @ matrix))
    return append(bare, copies, owners)


def count_copies(graph: SceneGraph, counted: dict[int, int] | None = None) -> int:
    """How many entities the instances of a scene, and those inside them, would become.

    ``counted`` keeps the numbers of prototypes, by id.
    """
    counted = {} if counted is None else counted
    total = 0
    for _, prototype in graph.entries(INSTANCES, "prototype"):
        if id(prototype) not in counted:
            counted[id(prototype)] = len(prototype) + count_copies(prototype, counted)
        total += counted[id(prototype)]
    return total


def _copy(prototype: SceneGraph, owner: str, matrix: NDArray[np.float64], world: NDArray[np.float64]) -> SceneGraph:
    """A prototype with uids of its own; its roots stand at ``matrix``, which is ``world`` in the scene it goes to."""
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
        said = components[RELATIONS]
        targets = [copy_of.get(uid, uid) for uid in said.columns["target"]]
        components[RELATIONS] = table(said.rows, kind=said.columns["kind"], target=targets)
    if ACTIONS in components:
        components[ACTIONS] = _retargeted(components[ACTIONS], uids, copy_of)
    return prototype.replace(uid=uids, local=local, components=components)


def _retargeted(actions: Table, uids: Sequence[str], copy_of: Mapping[str, str]) -> Table:
    owners = [uids[row] for row in actions.rows]
    data: list[ActionData] = list(actions.columns["data"])
    moved = dict(copy_of) | {
        action.uid: derived_uid(action.uid, owner) for action, owner in zip(data, owners, strict=True)
    }
    return table(actions.rows, data=[retarget_copy(*pair, moved) for pair in zip(data, owners, strict=True)])
