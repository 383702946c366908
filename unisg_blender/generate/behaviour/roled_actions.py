"""The actions of a scene as a model of behaviour sees them: who takes part, and where a lesson performs them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...behaviour import all_actions, operations
from ...scene import ActionData, LessonNode, SceneGraph

SLOTS = ("target", "tool", "frame")
"""The roles that an entity can have in an action."""

Slots = tuple[int, int, int]
"""Who has which role in an action, by the order of :data:`SLOTS`; -1 for nobody."""

Key = tuple[str, str, str, str]
"""Type, name, stage and group: actions of all scenes that agree in these are of one kind."""


@dataclass(frozen=True, eq=False)
class RoledAction:
    """An action with its roles and its place in a lesson.

    Attributes
    ----------
    action
        The action; of several targets or tools the first counts.
    owner
        Row of the entity that carries it.
    slots
        Rows of target, tool and frame, -1 for none.
    stage, leaf
        The stage that performs it (its group's, for a member) and the leaf (None for a member), None for no lesson.
    group
        Name of the Parallel group that it is a member of, "" for none.
    order
        Position of the leaf in its stage, -1 for none.
    name
        The action's name with "{target}" ... for the names of the entities that take part.
    """

    action: ActionData
    owner: int
    slots: Slots
    stage: LessonNode | None
    leaf: LessonNode | None
    group: str
    order: int
    name: str

    @property
    def key(self) -> Key:
        """What kind of action this is."""
        return self.action.type, self.name, "" if self.stage is None else self.stage.name, self.group


def read_roled_actions(graph: SceneGraph) -> list[RoledAction]:
    """The actions of a scene except the Parallel groups, in the order of its ``actions`` table."""
    found = graph.components.get("actions")
    actions = all_actions(graph)
    places = _places(graph, {action.uid: action for action in reversed(actions)})
    roled_actions = []
    for owner, action in zip([] if found is None else found.rows.tolist(), actions, strict=True):
        if action.type != "Parallel":
            stage, leaf, order, group = places.get(action.uid, (None, None, -1, ""))
            slots = slots_of(graph, action)
            name = _without_names(graph, action, slots)
            roled_actions.append(RoledAction(action, owner, slots, stage, leaf, group, order, name))
    return roled_actions


def slots_of(graph: SceneGraph, action: ActionData) -> Slots:
    """Rows of the first target, the first tool and the frame, -1 for none."""
    uids = next(iter(action.targets), ""), next(iter(action.tools), ""), action.frame
    target, tool, frame = (graph.row_of_uid.get(uid, -1) for uid in uids)
    return target, tool, frame


def _places(
    graph: SceneGraph, by_uid: Mapping[str, ActionData]
) -> dict[str, tuple[LessonNode, LessonNode | None, int, str]]:
    """Stage, leaf, order and group of each action, the first where it has several."""
    places: dict[str, tuple[LessonNode, LessonNode | None, int, str]] = {}
    stages = [node for operation in operations(graph) for node in operation.walk() if node.kind == "stage"]
    for stage, order, leaf in ((holder, *each) for holder in stages for each in enumerate(holder.children)):
        places.setdefault(leaf.action, (stage, leaf, order, ""))
        group = by_uid.get(leaf.action)
        for uid in group.members if group is not None and group.type == "Parallel" else ():
            places.setdefault(uid, (stage, None, order, group.name if group else ""))
    return places


def _without_names(graph: SceneGraph, action: ActionData, slots: Slots) -> str:
    name = action.name
    for slot, row in sorted(zip(SLOTS, slots, strict=True), key=lambda pair: -len(graph.name[pair[1]])):
        if row >= 0:
            name = name.replace(graph.name[row], f"{{{slot}}}")
    return name


def with_names(name: str, graph: SceneGraph, slots: Slots) -> str:
    """The name of a kind with the entities' names put in."""
    for slot, row in zip(SLOTS, slots, strict=True):
        name = name.replace(f"{{{slot}}}", graph.name[row] if row >= 0 else "")
    return name
