"""Actions, lessons and relations of one scene as rows."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...behaviour.lesson.action_vector import action_vector
from ...behaviour.lesson.behaviour_links import RELATIONS, behaviour_links
from ...scene import SceneGraph
from ...scene.action_data import actions_to_json
from ...scene.lesson_node import lesson_to_json
from .columns import Vocabulary

OWNED = ("entity", "has", "action")
LINKS = tuple(relation for relation in RELATIONS if relation != OWNED)
"""The kinds of edges between actions, lessons, stages and entities; ``link.kind`` holds positions in this tuple."""

Rows = dict[str, Any]


def relation_rows(graph: SceneGraph, vocabulary: Vocabulary) -> Rows:
    """Relations between entities of the scene; those to something outside are left out."""
    found: list[tuple[int, int, int]] = []
    for subject, kind, uid in graph.entries("relations", "kind", "target"):
        if uid in graph.row_of_uid:
            found.append((subject, graph.row_of_uid[uid], vocabulary.place("relations", kind)))
    columns = np.array(found, np.int32).reshape(-1, 3)
    return {"relation.subject": columns[:, 0], "relation.target": columns[:, 1], "relation.kind": columns[:, 2]}


def behaviour_rows(graph: SceneGraph) -> Rows:
    """Actions, lessons and stages as nodes, the edges between them, and the whole records as JSON."""
    vectors, links = action_vector(graph), behaviour_links(graph)
    edges = [links.edges[kind] for kind in LINKS]
    operations = graph.entries("lsa", "data")
    return {
        "action.entity": vectors.owner,
        "action.vector": vectors.values,
        "action.mask": vectors.mask,
        "action.record": [actions_to_json([action]) for action in vectors.actions],
        "link.kind": np.repeat(np.arange(len(LINKS)), [pairs.shape[1] for pairs in edges]),
        "link.source": np.concatenate([pairs[0] for pairs in edges]),
        "link.target": np.concatenate([pairs[1] for pairs in edges]),
        "lesson.vector": links.lesson_features,
        "lesson.name": [node.name for node in links.lessons],
        "stage.vector": links.stage_features,
        "stage.name": [node.name for node in links.stages],
        "operation.entity": [row for row, _ in operations],
        "operation.record": [lesson_to_json(tree) for _, tree in operations],
    }
