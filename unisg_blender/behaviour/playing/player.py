"""Play a lesson: state and moment in, new state and events out. Pure data, no clock, no scene.

lesson = prepare(graph)
state = begin(lesson)
for now in moments:
    state, events = play(lesson, state, now)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...scene.action_data import ActionData
from ...scene.graph import SceneGraph
from ...scene.lesson_node import LessonNode
from ..fulfilment.action_state import ActionState, Checks, compile_actions, start, step
from ..fulfilment.conditions import Condition
from ..fulfilment.snapshot import Moment
from ..lesson.action_places import all_actions, operations
from ..lesson.lesson_progress import DONE, OPEN, SKIPPED, WAITING, Change, advance, blockers, first_status
from ..lesson.lesson_tree import Outline, outline
from .explanation import explain
from .lesson_validation import check_lesson

KINDS = {OPEN: "opened", DONE: "done", SKIPPED: "skipped"}


@dataclass(frozen=True, eq=False)
class Lesson:
    """A lesson made ready to be played.

    ``task`` int64 (M,) is, for each node of the outline, the place of its action in
    ``checks`` (-1 for what is no leaf): every leaf has an action state of its own,
    even where two perform the same action.
    """

    graph: SceneGraph
    outline: Outline
    checks: Checks
    task: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class PlayState:
    """How far a lesson has come: ``status`` int8 (M,) of the nodes, and the state of the actions.

    ``began`` is the time of the first moment in seconds, None before it; ``first``
    bool (A,): the conditions that held then.
    """

    status: NDArray[np.int8]
    actions: ActionState
    began: float | None = None
    first: NDArray[np.bool_] | None = None

    @property
    def finished(self) -> bool:
        """The operation is done."""
        return bool(self.status[0] == DONE)


@dataclass(frozen=True)
class Event:
    """Something that happened while a lesson was played.

    ``kind`` is "opened", "done" or "skipped" (of the node ``uid``), "out_of_order"
    (an action was performed before its turn) or "wrong_answer"; ``time`` in
    seconds; ``action`` the uid of the action, "" for parts; ``why`` in words.
    """

    time: float
    kind: str
    uid: str
    node: str
    name: str
    action: str = ""
    why: str = ""


def prepare(
    graph: SceneGraph, operation: LessonNode | None = None, conditions: Mapping[str, Condition] | None = None
) -> Lesson:
    """Make a lesson of the scene ready; the scene's only operation when none is given.

    Raises
    ------
    UniSGError
        If there is no operation, or several, or the lesson has errors (the first is named).
    """
    found = operations(graph)
    if operation is None:
        if len(found) != 1:
            names = ", ".join(repr(each.name or each.uid) for each in found)
            raise UniSGError(
                f"the scene has several lessons: choose one of {names}" if found else "the scene has no lesson"
            )
        operation = found[0]
    errors = [problem.message for problem in check_lesson(graph, operation, conditions) if problem.severe]
    if errors:
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        raise UniSGError(f"the lesson cannot be played: {errors[0]}{more}")
    plan = outline(operation)
    actions, members, task = _tasks(plan, {action.uid: action for action in reversed(all_actions(graph))})
    return Lesson(graph, plan, compile_actions(graph, actions=actions, members=members, conditions=conditions), task)


def _tasks(
    plan: Outline, by_uid: Mapping[str, ActionData]
) -> tuple[list[ActionData], list[list[int]], NDArray[np.int64]]:
    actions: list[ActionData] = []
    members: list[list[int]] = []

    def add(action: ActionData) -> int:
        """Append an action with its members; its number."""
        place = len(actions)
        actions.append(action)
        members.append([])
        if action.type == "Parallel":
            members[place] = [add(by_uid[uid]) for uid in action.members]
        return place

    task = [add(by_uid[node.action]) if node.kind == "action" else -1 for node in plan.nodes]
    return actions, members, np.array(task, np.int64)


def begin(lesson: Lesson) -> PlayState:
    """The state before the first moment."""
    status, _ = advance(lesson.outline, first_status(lesson.outline), ())
    return PlayState(status, start(lesson.checks))


def play(lesson: Lesson, state: PlayState, moment: Moment) -> tuple[PlayState, tuple[Event, ...]]:
    """One moment: actions whose turn it is are checked, then the lesson moves on.

    What opens in this moment can be performed from the next one on, so that objects
    happen one after another even where all their conditions already hold.
    """
    leaves = np.flatnonzero(lesson.task >= 0)
    active = np.zeros(len(lesson.checks.actions), bool)
    active[lesson.task[leaves[state.status[leaves] == OPEN]]] = True
    actions = step(lesson.checks, state.actions, moment, active)
    performed = leaves[actions.done[lesson.task[leaves]] & (state.status[leaves] == OPEN)]
    status, changes = state.status, tuple[Change, ...]()
    if len(performed):
        status, changes = advance(lesson.outline, state.status, performed.tolist())
    began = moment.time if state.began is None else state.began
    first = actions.met if state.first is None else state.first
    events = [*_opened_at_start(lesson, state, moment)] if state.began is None else []
    events += _feedback(lesson, state, actions, moment, first)
    events += [_event(lesson, change, moment) for change in changes]
    return PlayState(status, actions, began, first), tuple(events)


def _opened_at_start(lesson: Lesson, state: PlayState, moment: Moment) -> Iterator[Event]:
    for place in np.flatnonzero(state.status == OPEN):
        yield _event(lesson, Change(int(place), OPEN), moment)


def _event(lesson: Lesson, change: Change, moment: Moment) -> Event:
    node, why = lesson.outline.nodes[change.place], ""
    name = node.name
    if node.kind == "action":
        action = lesson.checks.actions[lesson.task[change.place]]
        name = name or action.name or action.type
        why = explain(lesson.graph, action, moment) if change.status == DONE else ""
    return Event(moment.time, KINDS[change.status], node.uid, node.kind, name or node.uid, node.action, why)


def _feedback(
    lesson: Lesson, state: PlayState, new: ActionState, moment: Moment, first: NDArray[np.bool_]
) -> Iterator[Event]:
    """What the learner should hear: wrong answers, and actions that were performed before their turn.

    What was so from the ``first`` moment was not performed, nor what is put back to be so again.
    """
    actions, old = lesson.checks.actions, state.actions
    succeeding = new.active & (new.met | new.done & ~old.done)
    busy = {uid for place in np.flatnonzero(succeeding) for uid in _about(actions[place])}
    in_hand = {uid for place in np.flatnonzero(new.active) for uid in _about(actions[place])}
    early = (new.hits > old.hits) & (new.hits >= lesson.checks.hits) & ~new.active & ~old.active & ~first
    for leaf in np.flatnonzero(lesson.task >= 0):
        node, tasks = lesson.outline.nodes[leaf], _with_members(lesson.checks, int(lesson.task[leaf]))
        for place in tasks:
            action = actions[place]
            name = action.name or node.name or action.type
            excused = in_hand if action.type == "Remove" else busy  # what is being placed has to leave where it was
            if state.status[leaf] == WAITING and early[place] and not excused & set(_about(action)):
                why = f"{name!r} has to wait: {_waits_for(lesson, state, int(leaf))}"
                yield Event(moment.time, "out_of_order", node.uid, node.kind, name, action.uid, why)
            given = moment.answers.get(action.uid) if action.type == "Question" else None
            if given is not None and new.active[place] and not new.met[place]:
                chosen = ", ".join(action.answers[at] for at in given if 0 <= at < len(action.answers))
                yield Event(
                    moment.time, "wrong_answer", node.uid, node.kind, name, action.uid, f"{chosen!r} is not right"
                )


def _about(action: ActionData) -> Sequence[str]:
    return (*action.targets, *action.tools)


def _with_members(checks: Checks, place: int) -> list[int]:
    found, groups = [place], {group.index: group.members for group in checks.groups}
    for each in found:
        found += [int(member) for member in groups.get(each, ())]
    return found


def _waits_for(lesson: Lesson, state: PlayState, leaf: int) -> str:
    labels = [lesson.outline.label(place) for place in blockers(lesson.outline, state.status, leaf)[:3]]
    return f"first {' and '.join(labels)}" if labels else "it is not its turn"
