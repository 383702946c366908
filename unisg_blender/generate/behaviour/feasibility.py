"""Can actions be performed? They are rehearsed without the rest of the lesson, with what they need of the scene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...behaviour import prepare, rehearse
from ...errors import UniSGError
from ...scene import ActionData, LessonNode, SceneGraph, subtree, table, take

RATE = 1.0
"""Frames per second: a rehearsal needs no smooth motion."""


def unperformed(graph: SceneGraph, actions: Sequence[ActionData]) -> dict[str, str]:
    """Why actions cannot be performed one after another, by uid; empty if all can."""
    alone = [action for action in actions if action.type not in ("Parallel", "Question")]
    if not alone:
        return {}
    part = _stage_for(graph, alone)
    if _plays(part, alone):
        return {}
    return {
        action.uid: "it could not be performed" for action in alone if not _plays(_stage_for(graph, [action]), [action])
    } or {alone[-1].uid: "it could not be performed after the others"}


def _stage_for(graph: SceneGraph, actions: Sequence[ActionData]) -> SceneGraph:
    """The entities that take part, with what is below and above them."""
    uids = {uid for action in actions for uid in (*action.targets, *action.tools, action.frame)}
    keep = np.zeros(len(graph), bool)
    for uid in uids & graph.row_of_uid.keys():
        row = graph.row_of_uid[uid]
        keep[subtree(graph, row)] = True
        while (row := int(graph.parent[row])) >= 0:
            keep[row] = True
    rows = np.flatnonzero(keep)
    part = take(graph, rows)
    return part.with_component("actions", table([0] * len(actions), data=list(actions)))


def _plays(graph: SceneGraph, actions: Sequence[ActionData]) -> bool:
    leaves = tuple(LessonNode("action", f"leaf {n}", action=action.uid) for n, action in enumerate(actions))
    stage = LessonNode("stage", "stage", "stage", children=leaves)
    operation = LessonNode("operation", "operation", children=(LessonNode("lesson", "lesson", children=(stage,)),))
    try:
        rehearse(prepare(graph, operation), RATE)
    except UniSGError:
        return False
    return True
