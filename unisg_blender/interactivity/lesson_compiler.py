"""A scene's lesson as a behaviour graph of KHR_interactivity.

On every tick the graph does what :func:`~..behaviour.playing.player.play` does in a moment: looks which conditions
hold, tells what was done too early and which answers were wrong, makes performed leaves done and moves the lesson on.
Node k of the asset is the entity in row k of the scene, unless another numbering is given.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..behaviour.lesson.lesson_progress import OPEN, WAITING
from ..behaviour.playing.player import Lesson, begin, prepare
from ..scene import ActionData, LessonNode, SceneGraph
from .action_conditions import ActionConditions
from .action_steps import ActionSteps, GroupSteps, action_steps, group_steps, restarted
from .attention import Attention
from .behaviour_program import (
    NO,
    YES,
    Branch,
    Expression,
    GraphEvent,
    GraphVariable,
    Program,
    Send,
    Start,
    Step,
    StepBlock,
    all_of,
    any_of,
    put,
    whole,
)
from .graph_writer import graph_json
from .learner_inputs import LearnerInputs
from .lesson_steps import MISSED, PERFORMED, STARTED, LessonSteps
from .selection_moves import DRAGGING, SelectionMoves

EARLY = GraphEvent("unisg:early", {"task": "int"})
FAILED = GraphEvent("unisg:failed", {"task": "int"})


@dataclass(frozen=True, eq=False)
class LessonGraph:
    """A lesson as a graph.

    Attributes
    ----------
    graph
        The JSON of one graph of KHR_interactivity.
    lesson
        What it was made of: events name nodes of its outline and places of its actions ("task").
    lost
        What the graph cannot say, as (name of the action, what).
    """

    graph: dict[str, Any]
    lesson: Lesson
    lost: tuple[tuple[str, str], ...]

    def leaf_of(self, task: int) -> int:
        """The node of the outline that an action, or a member of its groups, belongs to."""
        return next(leaf for leaf in _leaves(self.lesson) if task in _tasks_of(self.lesson, leaf))


def lesson_graph(
    scene: SceneGraph, operation: LessonNode | None = None, node_of: Callable[[int], int] = int
) -> LessonGraph:
    """Compile a lesson of the scene, the only one when none is given; ``node_of`` a row is its node in the asset.

    Raises
    ------
    UniSGError
        If there is no lesson, or several, or it is not sound (as :func:`~..behaviour.playing.player.prepare`).
    """
    lesson = prepare(scene, operation)
    compiler = _Compiler(lesson, node_of)
    return LessonGraph(graph_json(compiler.program()), lesson, tuple(compiler.conditions.lost))


class _Compiler:
    def __init__(self, lesson: Lesson, node_of: Callable[[int], int]) -> None:
        self._lesson, self._node_of = lesson, node_of
        self._first, self._stirred = GraphVariable("first tick", YES), GraphVariable("stirred", NO)
        self._leaf_of = {task: leaf for leaf in _leaves(lesson) for task in _tasks_of(lesson, leaf)}
        self._tree = LessonSteps(lesson.outline, begin(lesson).status, self._restarts())
        self._inputs = LearnerInputs(lesson, node_of)
        self.conditions = ActionConditions(lesson, self._inputs)
        self._attention = Attention(self.conditions.batch, self._leaf_of)
        self._again = put(*self._attention.waking([]))
        self._steps: dict[int, ActionSteps | GroupSteps] = {}
        members = {group.index: group for group in lesson.checks.groups}
        for task in self._leaf_of:
            if task not in members:
                self._steps[task] = self._action(task)
        for task, group in members.items():  # inner ones first
            done = [self._steps[member].done.value for member in group.members.tolist()]
            self._steps[task] = group_steps(str(task), done, group.any, self._active(task))

    def program(self) -> Program:
        """All of the graph; a tick asks what has moved, and if nothing has changed, no more."""
        steps = [self._steps[task] for task in sorted(self._steps)]
        groups: list[Step] = [self._steps[group.index].update for group in self._lesson.checks.groups]
        actions = [
            self._attention.looks(
                task, steps.late, StepBlock([Branch(self._tree.is_pending(self._leaf_of[task]), steps.update)])
            )
            for task, steps in sorted(self._steps.items())
            if isinstance(steps, ActionSteps)
        ]
        leaves = {leaf: self._steps[int(self._lesson.task[leaf])].done.value for leaf in _leaves(self._lesson)}
        held = [(each.fair, ~each.met.value) for each in steps if isinstance(each, ActionSteps)]
        begins: list[Step] = [self._tree.began(), put((self._first, NO), *held)]
        stirred, changed, asked = self._stirred.value, self._tree.changed, self._inputs.asked.value
        look: list[Step] = [
            Branch(
                stirred, StepBlock([put((self._stirred, NO), *((each, NO) for step in steps for each in step.passing))])
            ),
            *actions,
            self._attention.rest(),
            Branch(stirred, StepBlock(groups)),
            Branch(self._first.value, StepBlock(begins)),
            Branch(stirred | asked, StepBlock([*self._feedback()])),
            Branch(changed.value, StepBlock([self._tree.seen()])),
            Branch(stirred, self._tree.advance(leaves)),
            Branch(asked, self._inputs.forget(self._attention)),
            Branch(changed.value, StepBlock([self._attention.wake_all()])),
        ]
        tick = StepBlock([*self._attention.movements(), self._attention.awake(look)])
        moves = SelectionMoves(self._lesson.graph, self.conditions.batch, self._inputs, self._attention, self._node_of)
        selected = moves.starts(sorted(self._leaf_of), self._may)
        own = [variable for each in steps for variable in each.variables]
        ours = (self._first, self._stirred)
        return Program(
            (
                *self._tree.variables,
                *ours,
                *own,
                *self._inputs.variables,
                *self._attention.variables,
                *self.conditions.variables,
                *moves.variables,
            ),
            (STARTED, PERFORMED, MISSED, EARLY, FAILED, *self._inputs.events, DRAGGING),
            (Start("event/onTick", tick), *self._inputs.starts(self._attention), *selected),
            self._node_of,
        )

    def _restarts(self) -> dict[int, list[tuple[GraphVariable, Expression]]]:
        """What is put when a leaf opens: a group itself has nothing that could start anew."""
        checks = self._lesson.checks
        found: dict[int, list[tuple[GraphVariable, Expression]]] = {}
        for task, leaf in self._leaf_of.items():
            if checks.actions[task].type != "Parallel":
                found.setdefault(leaf, []).extend(restarted(str(task), int(checks.hits[task])))
        return found

    def _action(self, task: int) -> ActionSteps:
        checks, leaf = self._lesson.checks, self._leaf_of[task]
        active = self._active(task)
        return action_steps(
            str(task), self.conditions.of(task), float(checks.hold[task]), int(checks.hits[task]),
            active, self._tree.is_at(leaf, WAITING), task != self._lesson.task[leaf], self._stirred,
            self._again,
        )  # fmt: skip

    def _active(self, task: int) -> Expression:
        return self._tree.is_at(self._leaf_of[task], OPEN)

    def _may(self, task: int) -> Expression:
        """An action may be performed and is not; what makes up its leaf is no longer active once it was performed."""
        active = self._active(task)
        whole_leaf = task == self._lesson.task[self._leaf_of[task]]
        return active if whole_leaf else active & ~self._steps[task].done.value

    def _feedback(self) -> Iterator[Step]:
        """What the learner should hear, as the player tells it: what was done too early, and wrong answers."""
        checks = self._lesson.checks
        for task in self._leaf_of:
            steps = self._steps[task]
            if not isinstance(steps, ActionSteps):
                continue
            values = {"task": whole(task)}
            early = all_of([
                steps.struck.value, steps.enough, steps.fair.value,
                *([~any_of(excuses)] if (excuses := list(self._excuses(task))) else []),
            ])  # fmt: skip
            yield Branch(early, StepBlock([Send(EARLY, values)]))
            if checks.actions[task].type == "Question":
                answered = self._inputs.answered(checks.actions[task].uid)
                wrong = all_of([answered, self._active(task), ~steps.met.value])
                yield Branch(wrong, StepBlock([Send(FAILED, values)]))

    def _excuses(self, task: int) -> Iterator[Expression]:
        """What makes something done too early no mistake: other actions of the same things are being performed.

        What is too early waits, and is no excuse for itself: so excuses are told once for each thing.
        """
        actions = self._lesson.checks.actions
        for thing in sorted(_about(actions[task])):
            others = [other for other in self._steps if thing in _about(actions[other])]
            if actions[task].type == "Remove":
                yield any_of(map(self._active, others))
            else:
                yield any_of(self._active(other) & self._succeeds(other) for other in others)

    def _succeeds(self, task: int) -> Expression:
        steps = self._steps[task]
        return steps.met.value if isinstance(steps, ActionSteps) else steps.fresh.value


def _about(action: ActionData) -> set[str]:
    return {*action.targets, *action.tools}


def _leaves(lesson: Lesson) -> list[int]:
    return np.flatnonzero(lesson.task >= 0).tolist()


def _tasks_of(lesson: Lesson, leaf: int) -> list[int]:
    """The places of a leaf's action and of all members of its groups, in the player's order."""
    members = {group.index: group.members.tolist() for group in lesson.checks.groups}
    found = [int(lesson.task[leaf])]
    for each in found:
        found += members.get(each, [])
    return found
