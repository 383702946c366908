"""Where each action stands in the Lesson-Stage-Action tree, as numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from ...scene.action_data import ActionData
from ...scene.graph import SceneGraph
from ...scene.lesson_node import LessonNode


@dataclass(frozen=True)
class ActionPlace:
    """The place of one action.

    ``lesson``, ``stage`` and ``leaf`` count the lessons, stages and leaves of the
    whole operation, depth first from 0; ``order`` counts within the stage;
    ``depth`` is the number of lessons above; ``requires`` the number of
    prerequisites; ``optional`` that of the leaf; ``ordered`` that of its stage;
    ``member`` is True for a member of a Parallel group, which has its group's place.
    """

    lesson: int
    stage: int
    order: int
    leaf: int
    depth: int
    requires: int
    optional: bool
    ordered: bool
    member: bool = False


def operations(graph: SceneGraph) -> tuple[LessonNode, ...]:
    """The operations (LSA trees) of a scene, in entity order."""
    return tuple(operation for _, operation in graph.entries("lsa", "data"))


def all_actions(graph: SceneGraph) -> tuple[ActionData, ...]:
    """All actions of a scene, in the order of its ``actions`` table."""
    return tuple(action for _, action in graph.entries("actions", "data"))


def action_places(graph: SceneGraph) -> dict[str, ActionPlace]:
    """The place of every action that a lesson performs, by action uid; the first place where it has several."""
    places: dict[str, ActionPlace] = {}
    for operation in operations(graph):
        for uid, place in _leaves(operation):
            places.setdefault(uid, place)
    by_uid = {action.uid: action for action in all_actions(graph)}
    for uid in list(places):
        _place_members(uid, by_uid, places)
    return places


def _leaves(operation: LessonNode) -> Iterator[tuple[str, ActionPlace]]:
    counts = {"lesson": 0, "stage": 0, "action": 0}

    def walk(node: LessonNode, lesson: int, stage: int, depth: int) -> Iterator[tuple[str, ActionPlace]]:
        """The places of all actions below a node."""
        for order, child in enumerate(node.children):
            number = counts[child.kind]
            counts[child.kind] += 1
            if child.kind == "action":
                place = ActionPlace(
                    lesson, stage, order, number, depth, len(child.requires), child.optional, node.ordered
                )  # fmt: skip
                yield child.action, place
            elif child.kind == "stage":
                yield from walk(child, lesson, number, depth)
            else:
                yield from walk(child, number, stage, depth + 1)

    yield from walk(operation, 0, 0, 0)


def _place_members(group: str, by_uid: Mapping[str, ActionData], places: dict[str, ActionPlace]) -> None:
    pending = [group]
    while pending:
        action = by_uid.get(pending.pop())
        for member in action.members if action is not None else ():
            if member not in places:
                places[member] = replace(places[group], member=True)
                pending.append(member)
