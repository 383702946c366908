"""What a page shows of a lesson besides its room: names, the tree, and what each action is about; JSON-ready."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..geometry.y_up import turned_matrices
from ..scene import ActionData, SceneGraph
from .lesson_compiler import LessonGraph


def lesson_sheet(compiled: LessonGraph) -> dict[str, Any]:
    """Title, parts of the lesson as events name them, actions as events name them, names and uids of entities.

    Entities are told by their nodes; poses are 16 numbers, column by column, in glTF's axes.
    """
    lesson = compiled.lesson
    graph, outline = lesson.graph, lesson.outline
    return {
        "title": outline.nodes[0].name or graph.title,
        "names": list(graph.name),
        "uids": list(graph.uid),
        "parts": [
            {"kind": node.kind, "name": _name(compiled, place), "parent": outline.parent[place],
             "task": int(lesson.task[place]), "optional": node.optional}
            for place, node in enumerate(outline.nodes)
        ],
        "tasks": [_task(graph, action, compiled.leaf_of(task)) for task, action in enumerate(lesson.checks.actions)],
    }  # fmt: skip


def _name(compiled: LessonGraph, place: int) -> str:
    node, task = compiled.lesson.outline.nodes[place], int(compiled.lesson.task[place])
    if task < 0:
        return node.name or node.kind.capitalize()
    action = compiled.lesson.checks.actions[task]
    return node.name or action.name or action.type


def _task(graph: SceneGraph, action: ActionData, leaf: int) -> dict[str, Any]:
    limits, reference = action.thresholds, action.reference_matrix
    return {
        "uid": action.uid,
        "type": action.type,
        "name": action.name or action.type,
        "leaf": leaf,
        "targets": [graph.row_of_uid[uid] for uid in action.targets],
        "tools": [graph.row_of_uid[uid] for uid in action.tools],
        "frame": graph.row_of_uid[action.frame] if action.frame else -1,
        "reference": None if reference is None else turned_matrices(np.asarray(reference)[None])[0].T.ravel().tolist(),
        "distance": limits.distance,
        "hold": limits.hold or 0.0,
        "hits": limits.hits or 1,
        "force": limits.force or 0.0,
        "trigger": action.trigger or action.type == "Tool",
        "answers": list(action.answers),
    }
