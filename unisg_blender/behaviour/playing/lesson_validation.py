"""Is a lesson sound? Everything that would make it impossible to play, in words that name the object."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from ...scene.action_data import ActionData
from ...scene.graph import SceneGraph
from ...scene.lesson_node import LessonNode
from ..fulfilment.conditions import Condition
from ..lesson.action_places import all_actions, operations
from ..lesson.lesson_tree import Outline, outline
from .action_validation import action_problems, group_members
from .deadlock import circles, unreached


@dataclass(frozen=True)
class Problem:
    """Something wrong with a lesson: ``severe`` if it cannot be played; ``uid`` of the node or action it is about."""

    message: str
    uid: str
    severe: bool = True


def check_scene(graph: SceneGraph, conditions: Mapping[str, Condition] | None = None) -> list[Problem]:
    """The problems of all lessons of a scene, and of actions that no lesson performs."""
    problems = [problem for each in operations(graph) for problem in check_lesson(graph, each, conditions)]
    by_uid = {action.uid: action for action in all_actions(graph)}
    used: set[str] = set()
    for operation in operations(graph):
        for node in operation.walk():
            used |= {node.action, *(member.uid for member in group_members(node.action, by_uid))}
    for uid, action in by_uid.items():
        if uid not in used:
            where = "no lesson performs it" if operations(graph) else "there is no lesson"
            problems.append(Problem(f"Action {_name(action)!r} is never performed: {where}", uid, severe=False))
            problems += [
                Problem(f"Action {_name(action)!r} {text}", uid)
                for text in action_problems(graph, action, by_uid, conditions)
            ]
    return problems


def check_lesson(
    graph: SceneGraph, operation: LessonNode, conditions: Mapping[str, Condition] | None = None
) -> list[Problem]:
    """The problems of one lesson, those of its nodes in order; an empty list if it is sound.

    Parameters
    ----------
    conditions
        The action types of your own, as for :func:`~..check.action_state.compile_actions`.
    """
    plan = outline(operation)
    actions = all_actions(graph)
    problems = [*_repeated(plan, actions)]
    if not any(node.kind == "action" for node in plan.nodes):
        problems.append(Problem(f"{plan.label(0)} has no actions", operation.uid))
    by_uid = {action.uid: action for action in reversed(actions)}
    for place, node in enumerate(plan.nodes):
        if node.kind == "action":
            problems += _leaf_problems(graph, plan, place, by_uid, conditions)
        elif not node.children and place:
            problems.append(Problem(f"{plan.label(place)} holds nothing", node.uid, severe=False))
        problems += _requirement_problems(plan, place)
    waiting = [Problem(message, plan.nodes[place].uid) for message, place in circles(plan)]
    problems += waiting or [
        Problem(f"{plan.label(place)} is optional and may never be reached", plan.nodes[place].uid, severe=False)
        for place in unreached(plan)
    ]
    return [replace(problem, message=problem.message[0].upper() + problem.message[1:]) for problem in problems]


def _repeated(plan: Outline, actions: tuple[ActionData, ...]) -> Iterator[Problem]:
    for uid, count in Counter(node.uid for node in plan.nodes).items():
        if count > 1:
            names = " and ".join(plan.label(place) for place, node in enumerate(plan.nodes) if node.uid == uid)
            yield Problem(f"{names} share one uid: remove one and add it anew", uid)
    used = {node.action for node in plan.nodes}
    for uid, count in Counter(action.uid for action in actions).items():
        if count > 1 and uid in used:
            names = " and ".join(repr(_name(action)) for action in actions if action.uid == uid)
            yield Problem(f"{count} actions share one uid ({names}): repair identities", uid)


def _leaf_problems(
    graph: SceneGraph,
    plan: Outline,
    place: int,
    by_uid: Mapping[str, ActionData],
    conditions: Mapping[str, Condition] | None,
) -> Iterator[Problem]:
    node = plan.nodes[place]
    stage = plan.label(plan.parent[place]) if plan.parent[place] >= 0 else "the lesson"
    if node.action not in by_uid:
        what = repr(node.name) if node.name else f"with uid {node.action!r}" if node.action else "(none chosen)"
        yield Problem(f"{stage} performs the action {what}, which is not in the scene", node.uid)
        return
    for action in (by_uid[node.action], *group_members(node.action, by_uid)):
        for text in action_problems(graph, action, by_uid, conditions):
            yield Problem(f"{stage} {text}", node.uid)


def _requirement_problems(plan: Outline, place: int) -> Iterator[Problem]:
    node, known = plan.nodes[place], {other.uid for other in plan.nodes}
    for uid in node.requires:
        if uid not in known:
            yield Problem(f"{plan.label(place)} requires something that is not in the lesson (uid {uid!r})", node.uid)
    related = {place, *plan.above(place), *plan.below(place)}
    for wanted in plan.requires[place]:
        if wanted in related:
            other = (
                "itself" if wanted == place else f"{plan.label(wanted)}, which is {_relation(plan, place, wanted)} it"
            )
            yield Problem(f"{plan.label(place)} requires {other}", node.uid)


def _relation(plan: Outline, place: int, other: int) -> str:
    return "above" if other in plan.above(place) else "inside"


def _name(action: ActionData) -> str:
    return action.name or f"{action.type} {action.uid}"
