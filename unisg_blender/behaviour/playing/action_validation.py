"""Is an action complete, and is what it needs there?"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...scene.action_data import ActionData
from ...scene.graph import SceneGraph
from ..fulfilment.conditions import CONDITIONS, Condition
from ..fulfilment.custom_types import OWN_CONDITIONS


def action_problems(
    graph: SceneGraph,
    action: ActionData,
    by_uid: Mapping[str, ActionData],
    conditions: Mapping[str, Condition] | None = None,
) -> list[str]:
    """What keeps an action from ever being performed, as ends of a sentence: "needs 'Scalpel', which is not ..."."""
    texts = [
        f"needs {action.names.get(uid, uid)!r}, which is not in the scene"
        for uid in dict.fromkeys((*action.targets, *action.tools, action.frame))
        if uid and uid not in graph.row_of_uid
    ]
    name = repr(action.name or f"{action.type} {action.uid}")
    if action.type in CHECKS:
        texts += [f"has the action {name}, which {text}" for text in CHECKS[action.type](action, by_uid)]
    elif action.type not in {**OWN_CONDITIONS, **(conditions or {})}:
        texts.append(f"has the action {name} of the unknown type {action.type!r}: load the file that defines it")
    return texts


def group_members(uid: str, by_uid: Mapping[str, ActionData]) -> list[ActionData]:
    """The members of a Parallel group and of the groups in it, each once; [] for what is no group."""
    found: dict[str, ActionData] = {}
    pending = [uid]
    while pending:
        action = by_uid.get(pending.pop())
        for member in action.members if action is not None and action.type == "Parallel" else ():
            if member in by_uid and member not in found and member != uid:
                found[member] = by_uid[member]
                pending.append(member)
    return list(found.values())


def _pose(action: ActionData, by_uid: Mapping[str, ActionData]) -> Iterator[str]:
    if not action.targets:
        yield "has no target"
    if action.type == "Insert" and action.reference is None:
        yield "has no reference pose"
    if action.thresholds.distance is None and action.thresholds.angle is None:
        yield "asks for neither distance nor angle"


def _use(action: ActionData, by_uid: Mapping[str, ActionData]) -> Iterator[str]:
    if not action.tools:
        yield "has no tool"
    if not action.targets and not (action.type == "Tool" and action.reference is not None):
        yield "has no target"
    if set(action.targets) & set(action.tools) and len({*action.targets, *action.tools}) == 1:
        yield "has its tool as its own target"


def _question(action: ActionData, by_uid: Mapping[str, ActionData]) -> Iterator[str]:
    if not action.answers:
        yield "has no answers"
    elif not action.correct:
        yield "has no right answer"
    elif not all(0 <= place < len(action.answers) for place in action.correct):
        yield "calls an answer right that it does not have"


def _parallel(action: ActionData, by_uid: Mapping[str, ActionData]) -> Iterator[str]:
    if not action.members:
        yield "has no members"
    for uid in action.members:
        if uid not in by_uid:
            yield f"groups {action.names.get(uid, uid)!r}, which is not in the scene"
    if _in_itself(action, by_uid):
        yield "is a member of itself"


def _in_itself(action: ActionData, by_uid: Mapping[str, ActionData]) -> bool:
    groups = (action, *group_members(action.uid, by_uid))
    return any(action.uid in group.members for group in groups if group.type == "Parallel")


CHECKS = {
    "Insert": _pose,
    "Remove": _pose,
    "Use": _use,
    "Tool": _use,
    "Question": _question,
    "Parallel": _parallel,
}
assert set(CHECKS) == {*CONDITIONS, "Parallel"}
