"""Which answer of a question is right: rules that held in all training scenes, and their answers in a new one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Floats
from ...scene import SceneGraph, world_matrices
from .action_kinds import AnswerRule, Kind
from .roled_actions import RoledAction, relation_kinds, support_rows

HOLDS = 0.99
"""Share of the training scenes in which a rule has to be right."""

AXES = "xyz"


@dataclass(frozen=True, eq=False)
class Asked:
    """A question of a training scene: the right answer, the objects there, and where the target is in what holds it."""

    answers: tuple[str, ...]
    right: str
    counts: Counter[str]
    place: Floats


def asked_of(graph: SceneGraph, roled_action: RoledAction) -> Asked:
    """What there is to learn from a question with one right answer ("" for the right one otherwise)."""
    correct = roled_action.action.correct
    right = (
        roled_action.action.answers[correct[0]]
        if len(correct) == 1 and correct[0] < len(roled_action.action.answers)
        else ""
    )
    return Asked(roled_action.action.answers, right, object_counts(graph), _place(graph, roled_action.slots[0]))


def object_counts(graph: SceneGraph) -> Counter[str]:
    """How many objects there are by "category", and by "category|relation to what holds them"."""
    kinds, counts = relation_kinds(graph), Counter[str]()
    for row in np.flatnonzero(graph.category >= 0).tolist():
        name = graph.category_name(row)
        counts[name] += 1
        if row in kinds:
            counts[f"{name}|{kinds[row]}"] += 1
    return counts


def _place(graph: SceneGraph, row: int) -> Floats:
    """Where a row is in the frame of what holds it, (3,)."""
    if row < 0:
        return np.zeros(3)
    world, above = world_matrices(graph), int(support_rows(graph)[row])
    return world[row, :3, 3] if above < 0 else (np.linalg.pinv(world[above]) @ world[row])[:3, 3]


def learn_answer_rule(asked: Sequence[Asked]) -> AnswerRule | None:
    """The first rule that is right in (nearly) all training scenes; None if none is."""
    if not asked or not all(question.right for question in asked):
        return None
    always = Counter(question.right for question in asked).most_common(1)[0]
    if always[1] >= HOLDS * len(asked) and all(always[0] in question.answers for question in asked):
        return AnswerRule("always", always[0], asked[0].answers)
    names = sorted(set().union(*(question.counts for question in asked)))
    for name in sorted(names, key=lambda name: ("|" in name, name)):
        if np.mean([str(question.counts[name]) == question.right for question in asked]) >= HOLDS:
            return AnswerRule("count", name)
    answers = tuple(sorted(set().union(*(question.answers for question in asked))))
    for axis in range(3) if len(answers) == 2 else ():
        for first, second in (answers, answers[::-1]):
            said = [first if question.place[axis] > 0 else second for question in asked]
            if np.mean([one == question.right for one, question in zip(said, asked, strict=True)]) >= HOLDS:
                return AnswerRule("side", AXES[axis], (first, second))
    return None


def answers_of(kind: Kind, graph: SceneGraph, target: int) -> tuple[tuple[str, ...], int] | None:
    """Answers of a question in a scene and the position of the right one; None where no rule tells."""
    right = kind.right
    if right is None:
        return None
    if right.rule == "always":
        return kind.answers, kind.answers.index(right.of) if right.of in kind.answers else 0
    if right.rule == "side":
        first = right.answers[0] if _place(graph, target)[AXES.index(right.of)] > 0 else right.answers[1]
        return kind.answers, kind.answers.index(first)
    count = object_counts(graph)[right.of]
    low = max(count - 1, 0)
    return tuple(str(number) for number in range(low, low + max(len(kind.answers), 2))), count - low
