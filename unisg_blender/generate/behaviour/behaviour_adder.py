"""Gives new objects behaviour: one action after another, as long as the lesson can be played to its end."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...behaviour import check_scene, operations
from ...geometry.arrays import Floats
from ...scene import ActionData, LessonNode, SceneGraph
from .action_policy import ActionChoice, ActionPolicy, RoleMasks
from .feasibility import unperformed
from .lesson_draft import LessonDraft, UidMaker
from .new_actions import NewAction, make_action, with_actions, with_operation
from .observation import observe_behaviour
from .roled_actions import Slots, read_roled_actions

MOST = 500
"""Actions made in one call, at most."""

ROUNDS = 12
"""Times that it is begun anew without the role assignments that did not stand the checks."""

Assignment = tuple[int, Slots]
"""A kind of action, and which objects take part."""


@dataclass(frozen=True, eq=False)
class Behaviour:
    """A ``scene`` with new behaviour; names of the new ``actions``, and ``notes``, by uid of the new object."""

    scene: SceneGraph
    actions: dict[str, list[str]]
    notes: dict[str, list[str]]


def add_behaviour(
    graph: SceneGraph, new: Collection[str], policy: ActionPolicy, make_uid: UidMaker,
    rng: np.random.Generator | None = None,
) -> Behaviour:  # fmt: skip
    """Give actions to the objects with the uids ``new``, and places in the lesson to the actions.

    Nothing that was there is changed: an action belongs to a new object, an existing
    lesson is extended by leaves and stages, a scene without one gets a lesson of its own. An action is only made if
    it adds no complaint to ``check_scene`` and can be performed (rehearsed with the
    other new ones, in the order of the lesson); else the next best role assignment is tried, at
    last none, and a note says so. What is done in some scenes only is made if ``rng`` draws it, without
    one only if it is done more often than not.
    """
    limits = RoleMasks(policy.kinds).limits(rng)
    banned: dict[Assignment, str] = {}
    for _ in range(ROUNDS):
        work = _Round(graph, new, policy, make_uid, limits, banned)
        work.choose()
        scene, bad = work.checked()
        if not bad:
            return Behaviour(scene, work.names(), work.notes)
        banned |= bad
    return Behaviour(graph, {}, {uid: ["no actions: none could be performed"] for uid in new})


class _Round:
    """One round of :func:`add_behaviour`: the actions ``made`` with their assignments, groups of them, and a lesson."""

    def __init__(
        self, graph: SceneGraph, new: Collection[str], policy: ActionPolicy, make_uid: UidMaker, limits: Floats,
        banned: Mapping[Assignment, str],
    ) -> None:  # fmt: skip
        self.graph, self.policy, self.make_uid = graph, policy, make_uid
        self.limits, self.banned, self.kinds = limits, banned, policy.kinds
        roled_actions = read_roled_actions(graph)
        self.observed = observe_behaviour(graph, self.kinds, new, roled_actions)
        self.draft = LessonDraft(_operation(graph, self.kinds.stage_number), self.kinds, make_uid)
        self.leaf_uids = ["" if roled.leaf is None else roled.leaf.uid for roled in roled_actions]
        self.made: list[NewAction] = []
        self.groups: list[NewAction] = []
        self.assignments: list[Assignment] = []
        self.notes: dict[str, list[str]] = defaultdict(list)

    def choose(self) -> None:
        """Make actions until the policy wants no more."""
        masks = RoleMasks(self.kinds)
        blocked: set[int] = set()
        while len(self.made) < MOST and masks.any_new(self.observed):
            scores = self.policy.scores(self.observed)
            scores.wanted[list(blocked)] = 0.0
            choices = masks.choices(self.observed, scores, self.limits)
            if not choices:
                break
            if not any(self._make(choice) for choice in choices):
                blocked.add(choices[0].kind)
        self._add_groups()

    def _make(self, choice: ActionChoice) -> bool:
        """Make the action of a choice unless it is known not to do."""
        kind, slots = self.kinds.kinds[choice.kind], choice.slots
        if (choice.kind, slots) in self.banned:
            return self._note(slots, f"no {kind.name!r}: {self.banned[choice.kind, slots]}")
        target, tool, frame = (int(self.observed.rows[slot]) if slot >= 0 else -1 for slot in slots)
        uid = self.make_uid(kind.name)
        action = make_action(kind, self.graph, (target, tool, frame), uid)
        if action is None:
            return self._note(slots, f"no {kind.name!r}: no rule tells the correct answer")
        leaf, after = "", None
        if kind.stage and not kind.group:
            after = self.policy.after(self.observed, choice)
            leaf = self.make_uid("leaf")
            node = LessonNode("action", leaf, action.name, action=uid, optional=kind.optional)
            self.draft.add_leaf(node, kind.stage, self.leaf_uids[after] if after >= 0 else "")
        rows = zip((target, tool, frame), slots, strict=True)
        owner = next(row for row, slot in rows if slot >= 0 and self.observed.new[slot])
        self.made.append(NewAction(kind, owner, action, leaf))
        self.assignments.append((choice.kind, slots))
        self.leaf_uids.append(leaf)
        stage = self.kinds.stage_number.get(kind.stage, -1)
        self.observed = self.observed.with_action(choice.kind, slots, stage, after)
        return True

    def _note(self, slots: Slots, text: str) -> bool:
        for uid in self._new_of(slots):
            if text not in self.notes[uid]:
                self.notes[uid].append(text)
        return False

    def _new_of(self, slots: Slots) -> list[str]:
        """Uids of the new objects that take part."""
        return [self.graph.uid[self.observed.rows[slot]] for slot in slots if slot >= 0 and self.observed.new[slot]]

    def names(self) -> dict[str, list[str]]:
        """Names of the actions by uid of the new objects that take part in them."""
        found: dict[str, list[str]] = defaultdict(list)
        for new, (_, slots) in zip(self.made, self.assignments, strict=True):
            for uid in self._new_of(slots):
                found[uid].append(new.action.name)
        return dict(found)

    def _add_groups(self) -> None:
        """Members of Parallel groups: one new group for all of a name, or leaves beside a group that is there."""
        members: dict[tuple[str, str], list[int]] = defaultdict(list)
        for number, new in enumerate(self.made):
            if new.kind.group:
                members[new.kind.stage, new.kind.group].append(number)
        for (stage, group), numbers in members.items():
            actions, holder = [self.made[number].action for number in numbers], self.draft.stage_of(stage)
            if len(numbers) > 1 and not (holder and any(leaf.name == group for leaf in holder.children)):
                action = ActionData(
                    self.make_uid(group), "Parallel", group, members=tuple(action.uid for action in actions),
                    mode=self.kinds.groups.get(group, "all"), names={action.uid: action.name for action in actions},
                )  # fmt: skip
                first = self.made[numbers[0]]
                self.groups.append(NewAction(first.kind, first.owner, action, self._last_leaf(stage, action)))
                continue
            for number, action in zip(numbers, actions, strict=True):
                self.made[number] = replace(self.made[number], leaf=self._last_leaf(stage, action))

    def _last_leaf(self, stage: str, action: ActionData) -> str:
        """Put a leaf at the end of a stage; returns its uid."""
        found, uid = self.draft.stage_of(stage), self.make_uid("leaf")
        last = found.children[-1].uid if found is not None and found.children else ""
        self.draft.add_leaf(LessonNode("action", uid, action.name, action=action.uid), stage, last)
        return uid

    def checked(self) -> tuple[SceneGraph, dict[Assignment, str]]:
        """The scene with the new actions and the lesson, and the assignments that the checks complain about, with
        why."""
        if not self.made:
            return self.graph, {}
        scene, tree = with_actions(self.graph, [*self.made, *self.groups]), self.draft.finished()
        if tree is not None:
            scene = with_operation(scene, tree, self.make_uid("Operation"))
        before = {(problem.uid, problem.message) for problem in check_scene(self.graph)}
        found = [item for item in check_scene(scene) if (item.uid, item.message) not in before]
        why = {item.uid: item.message for item in found if item.severe or tree is not None}
        order = {} if tree is None else {node.action: position for position, node in enumerate(tree.walk())}
        actions = sorted((new.action for new in self.made), key=lambda action: order.get(action.uid, len(order)))
        why = why or unperformed(scene, actions)
        bad = {
            assignment: why.get(new.action.uid, why.get(new.leaf, ""))
            for new, assignment in zip(self.made, self.assignments, strict=True)
            if new.action.uid in why or (new.leaf and new.leaf in why)
        }
        if why and not bad:  # the complaint is about a stage or group: begin without the last action
            bad = {self.assignments[-1]: next(iter(why.values()))}
        return scene, bad


def _operation(graph: SceneGraph, stages: Mapping[str, int]) -> LessonNode | None:
    """The operation with most of the known stages; None in a scene without any."""
    found = operations(graph)
    return max(found, key=lambda tree: sum(node.name in stages for node in tree.walk()), default=None)
