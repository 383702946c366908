"""Which answer of a question is correct: rules that held in all training scenes, and their answers in a new one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Floats
from ...scene import SceneGraph, world_matrices
from ...spatial import find_supports
from .action_kinds import AnswerRule, Kind
from .roled_actions import RoledAction

HOLDS = 0.99
"""Share of the training scenes in which a rule has to give the correct answer."""

AXES = "xyz"


@dataclass(frozen=True, eq=False)
class Asked:
    """A question of a training scene: the one ``correct`` answer ("" if there is not one), how many objects there are,
    and the target's ``position`` (3,) in what holds it."""

    answers: tuple[str, ...]
    correct: str
    counts: Counter[str]
    position: Floats


def asked_of(graph: SceneGraph, roled: RoledAction) -> Asked:
    """What there is to learn from a question."""
    answers, correct = roled.action.answers, roled.action.correct
    one = answers[correct[0]] if len(correct) == 1 and correct[0] < len(answers) else ""
    return Asked(answers, one, object_counts(graph), _position(graph, roled.slots[0]))


def object_counts(graph: SceneGraph) -> Counter[str]:
    """How many objects there are by "category", and by "category|relation to what holds them"."""
    supports, counts = find_supports(graph), Counter[str]()
    for row, kind in zip(supports.objects.rows.tolist(), supports.first_kind.tolist(), strict=True):
        if name := graph.category_name(row):
            counts[name] += 1
            if kind:
                counts[f"{name}|{kind}"] += 1
    return counts


def _position(graph: SceneGraph, row: int) -> Floats:
    """Where a row is in the frame of what holds it, (3,)."""
    if row < 0:
        return np.zeros(3)
    world, above = world_matrices(graph), int(find_supports(graph).by_row[row])
    return world[row, :3, 3] if above < 0 else (np.linalg.pinv(world[above]) @ world[row])[:3, 3]


def learn_answer_rule(asked: Sequence[Asked]) -> AnswerRule | None:
    """The first rule that is right in (nearly) all training scenes; None if none is."""
    if not asked or not all(question.correct for question in asked):
        return None
    correct = [question.correct for question in asked]
    always, times = Counter(correct).most_common(1)[0]
    if times >= HOLDS * len(asked) and all(always in question.answers for question in asked):
        return AnswerRule("always", always, asked[0].answers)
    names = sorted(set().union(*(question.counts for question in asked)))
    for name in sorted(names, key=lambda name: ("|" in name, name)):
        if _agree([str(question.counts[name]) for question in asked], correct):
            return AnswerRule("count", name)
    answers = tuple(sorted(set().union(*(question.answers for question in asked))))
    for axis in range(3) if len(answers) == 2 else ():
        for first, second in (answers, answers[::-1]):
            if _agree([first if question.position[axis] > 0 else second for question in asked], correct):
                return AnswerRule("side", AXES[axis], (first, second))
    return None


def _agree(said: Sequence[str], correct: Sequence[str]) -> bool:
    return bool(np.mean([one == other for one, other in zip(said, correct, strict=True)]) >= HOLDS)


def answers_of(kind: Kind, graph: SceneGraph, target: int) -> tuple[tuple[str, ...], int] | None:
    """Answers of a question in a scene and the position of the correct one; None where no rule tells."""
    rule = kind.answer_rule
    if rule is None:
        return None
    if rule.rule == "always":
        return kind.answers, kind.answers.index(rule.of) if rule.of in kind.answers else 0
    if rule.rule == "side":
        first = rule.answers[0] if _position(graph, target)[AXES.index(rule.of)] > 0 else rule.answers[1]
        return kind.answers, kind.answers.index(first)
    count = object_counts(graph)[rule.of]
    low = max(count - 1, 0)
    return tuple(str(number) for number in range(low, low + max(len(kind.answers), 2))), count - low
