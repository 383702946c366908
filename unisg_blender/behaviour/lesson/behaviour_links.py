"""Behaviour as a graph: which action, stage and lesson is joined to which, and to which entity."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...scene.graph import SceneGraph
from ...scene.lesson_node import LessonNode
from .action_places import all_actions, operations
from .lesson_tree import Outline, outline

Relation = tuple[str, str, str]

NODE_CHANNELS = ("depth", "order", "children", "requires", "optional", "ordered")
"""Channels of a lesson's or stage's features: levels below the operation, position among its siblings,
number of children, number of prerequisites, and two flags."""

RELATIONS: tuple[Relation, ...] = (
    ("entity", "has", "action"),
    ("action", "targets", "entity"),
    ("action", "uses", "entity"),
    ("action", "in_frame_of", "entity"),
    ("action", "groups", "action"),
    ("action", "precedes", "action"),
    ("stage", "contains", "action"),
    ("lesson", "contains", "stage"),
    ("lesson", "contains", "lesson"),
)
"""The kinds of edges: (source, relation, destination)."""


@dataclass(frozen=True, eq=False)
class BehaviourLinks:
    """Nodes and edges of a scene's behaviour.

    ``lessons`` and ``stages`` depth first over all operations, with their features
    float64 (L, 6) and (S, 6) in the order of :data:`NODE_CHANNELS`; ``edges`` maps
    every kind of :data:`RELATIONS` to int64 (2, E), source row over destination
    row: entities and actions count as in the graph and its ``actions`` table.
    References to what is not in the scene have no edge.
    """

    lessons: tuple[LessonNode, ...]
    stages: tuple[LessonNode, ...]
    lesson_features: NDArray[np.float64]
    stage_features: NDArray[np.float64]
    edges: dict[Relation, NDArray[np.int64]]


def behaviour_links(graph: SceneGraph) -> BehaviourLinks:
    """The behaviour of a scene as nodes and edges, sized for a heterogeneous graph.

    ``precedes`` joins each leaf to the next in an ordered stage, the last actions
    of a part to the first of the next where the order is fixed, and the actions of
    a prerequisite to those that wait for it.
    """
    pairs: dict[Relation, list[tuple[int, int]]] = {relation: [] for relation in RELATIONS}
    _action_edges(graph, pairs)
    number = _numbers(graph)
    rows: dict[str, list[tuple[LessonNode, list[float]]]] = {"lesson": [], "stage": []}
    for operation in operations(graph):
        _collect(outline(operation), number, rows, pairs)
        pairs["action", "precedes", "action"] += sorted(set(_precedes(operation, number)))
    features = {
        kind: np.array([numbers for _, numbers in found]).reshape(-1, len(NODE_CHANNELS))
        for kind, found in rows.items()
    }
    return BehaviourLinks(
        lessons=tuple(node for node, _ in rows["lesson"]),
        stages=tuple(node for node, _ in rows["stage"]),
        lesson_features=features["lesson"],
        stage_features=features["stage"],
        edges={relation: np.array(found, np.int64).reshape(-1, 2).T for relation, found in pairs.items()},
    )


def _numbers(graph: SceneGraph) -> dict[str, int]:
    """The place of each action by uid; of those that share one, of the first."""
    return {action.uid: index for index, action in reversed(list(enumerate(all_actions(graph))))}


def _action_edges(graph: SceneGraph, pairs: dict[Relation, list[tuple[int, int]]]) -> None:
    row_of, number = graph.row_of_uid, _numbers(graph)
    for index, (row, action) in enumerate(graph.entries("actions", "data")):
        pairs["entity", "has", "action"].append((row, index))
        named = {"targets": action.targets, "uses": action.tools, "in_frame_of": (action.frame,)}
        for relation, uids in named.items():
            pairs["action", relation, "entity"] += [(index, row_of[uid]) for uid in uids if uid in row_of]
        pairs["action", "groups", "action"] += [(index, number[uid]) for uid in action.members if uid in number]


def _collect(
    plan: Outline,
    number: dict[str, int],
    rows: dict[str, list[tuple[LessonNode, list[float]]]],
    pairs: dict[Relation, list[tuple[int, int]]],
) -> None:
    """Add the lessons and stages of an operation, and what they contain."""
    row_of: dict[int, int] = {}
    for place, node in enumerate(plan.nodes):
        above = plan.parent[place]
        if node.kind == "action":
            if above in row_of and node.action in number:
                pairs["stage", "contains", "action"].append((row_of[above], number[node.action]))
        elif above >= 0:
            row_of[place], order = len(rows[node.kind]), plan.children[above].index(place)
            depth = len(plan.above(place)) - 1
            numbers = [depth, order, len(node.children), len(node.requires), node.optional, node.ordered]
            rows[node.kind].append((node, [float(value) for value in numbers]))
            if above in row_of:
                pairs["lesson", "contains", node.kind].append((row_of[above], row_of[place]))


def _precedes(operation: LessonNode, number: dict[str, int]) -> Iterator[tuple[int, int]]:
    by_uid = {node.uid: node for node in operation.walk()}
    for node in operation.walk():
        if node.ordered:
            for before, after in pairwise(node.children):
                yield from _product(_edge(before, False), _edge(after, True), number)
        for uid in node.requires:
            if uid in by_uid:
                yield from _product(_edge(by_uid[uid], False), _edge(node, True), number)


def _product(before: list[str], after: list[str], number: dict[str, int]) -> Iterator[tuple[int, int]]:
    for first in before:
        for second in after:
            if first in number and second in number:
                yield number[first], number[second]


def _edge(node: LessonNode, first: bool) -> list[str]:
    """The actions with which a part begins (``first``) or ends; in any order, all of them are both."""
    if node.kind == "action":
        return [node.action]
    children = node.children
    if node.ordered and children:
        children = children[:1] if first else children[-1:]
    return [uid for child in children for uid in _edge(child, first)]
