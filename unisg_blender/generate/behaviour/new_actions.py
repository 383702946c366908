"""From choices to data: ActionData of a kind for those that take part, and the scene with new actions and a lesson."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...scene import ActionData, LessonNode, SceneBuilder, SceneGraph, Thresholds, append, entry_table
from .action_kinds import Kind
from .answer_rules import answers_of
from .reference_poses import reference_pose, surroundings
from .roled_actions import Slots, with_names

OPERATION = "Operation"


@dataclass(frozen=True, eq=False)
class NewAction:
    """An action to be added: its kind, the row of the entity that carries it, and its leaf's uid ("" for none)."""

    kind: Kind
    owner: int
    action: ActionData
    leaf: str = ""


def make_action(kind: Kind, graph: SceneGraph, slots: Slots, uid: str) -> ActionData | None:
    """An action of a kind for entities (rows, -1: nobody); None for a question whose answer no rule tells."""
    target, tool, frame = slots
    names = {graph.uid[row]: graph.name[row] for row in slots if row >= 0}
    answers: tuple[str, ...] = ()
    correct: tuple[int, ...] = ()
    if kind.type == "Question":
        told = answers_of(kind, graph, target)
        if told is None:
            return None
        answers, correct = told[0], (told[1],)
    reference = None
    if kind.reference is not None:
        moved = tool if kind.type == "Tool" else target
        pose = reference_pose(kind.reference, *surroundings(graph, moved, frame))
        reference = (*np.round(pose[:3], 9).reshape(-1).tolist(), 0.0, 0.0, 0.0, 1.0)
    limits = {name: int(value) if name == "hits" else value for name, value in kind.thresholds.items()}
    return ActionData(
        uid=uid, type=kind.type, name=with_names(kind.name, graph, slots),
        targets=(graph.uid[target],) if target >= 0 else (), tools=(graph.uid[tool],) if tool >= 0 else (),
        reference=reference, frame=graph.uid[frame] if frame >= 0 else "",
        thresholds=Thresholds(**limits),  # type: ignore[arg-type]
        trigger=kind.trigger, answers=answers, correct=correct, names=names,
    )  # fmt: skip


def with_actions(graph: SceneGraph, made: Sequence[NewAction]) -> SceneGraph:
    """The scene with further actions, each entity's own ones first."""
    entries = [*graph.entries("actions", "data"), *((new.owner, new.action) for new in made)]
    return graph.with_component("actions", entry_table(entries, "data"))


def with_operation(graph: SceneGraph, operation: LessonNode, uid: str) -> SceneGraph:
    """The scene with an operation in place of the one with its uid, else on a new Empty with the given ``uid``."""
    trees = [(row, operation if tree.uid == operation.uid else tree) for row, tree in graph.entries("lsa", "data")]
    if any(tree is operation for _, tree in trees):
        return graph.with_component("lsa", entry_table(trees, "data"))
    empty = SceneBuilder()
    empty.add(_free(OPERATION, graph), uid=uid, lsa=operation)
    return append(graph, [empty.build()])


def _free(name: str, graph: SceneGraph) -> str:
    taken, number, free = set(graph.name), 0, name
    while free in taken:
        number += 1
        free = f"{name}.{number:03d}"
    return free
