"""Take things out of a scene, and what is said of them: actions, parts of the lesson, relations."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from ...behaviour.lesson.edit import without_leaves
from ...scene import SceneGraph, entry_table
from ...scene.action_data import ActionData
from ...scene.components import ACTIONS, LSA, RELATIONS
from ...scene.hierarchy import subtree, take


def without_things(graph: SceneGraph, rows: Iterable[int]) -> SceneGraph:
    """The scene without the things at some rows and all below them, and without what refers to them.

    Actions in which one of them is target, tool or frame go, with their leaves of the lesson; groups lose them.
    """
    gone = np.zeros(len(graph), bool)
    for row in rows:
        gone[subtree(graph, row)] = True
    if not gone.any():
        return graph
    uids = {graph.uid[row] for row in np.flatnonzero(gone).tolist()}
    lost = {action.uid for row, action in graph.entries(ACTIONS, "data") if gone[row] or _refers(action, uids)}
    return _without_actions(_without_relations(take(graph, np.flatnonzero(~gone)), uids), lost)


def without_lesson(graph: SceneGraph) -> SceneGraph:
    """The scene without any action or lesson."""
    kept = {name: table for name, table in graph.components.items() if name not in (ACTIONS, LSA)}
    return graph.replace(components=kept)


def _refers(action: ActionData, uids: set[str]) -> bool:
    return bool(uids & {*action.targets, *action.tools, action.frame})


def _without_relations(graph: SceneGraph, uids: set[str]) -> SceneGraph:
    if RELATIONS not in graph.components:
        return graph
    said = [entry for entry in graph.entries(RELATIONS, "kind", "target") if entry[2] not in uids]
    return graph.with_component(RELATIONS, entry_table(said, "kind", "target"))


def _without_actions(graph: SceneGraph, lost: set[str]) -> SceneGraph:
    """The scene without some actions; a group goes with its last member."""
    entries: list[tuple[int, ActionData]] = []
    lost = set(lost)
    for row, action in graph.entries(ACTIONS, "data"):
        left = tuple(member for member in action.members if member not in lost)
        if action.uid in lost or (action.members and not left):
            lost.add(action.uid)
        else:
            entries.append((row, action if left == action.members else replace(action, members=left)))
    if not lost:
        return graph
    graph = graph.with_component(ACTIONS, entry_table(entries, "data"))
    trees = [(row, without_leaves(tree, lost)) for row, tree in graph.entries(LSA, "data")]
    return graph.with_component(LSA, entry_table([entry for entry in trees if entry[1].children], "data"))
