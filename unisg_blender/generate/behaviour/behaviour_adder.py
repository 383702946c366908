"""Gives new objects behaviour: one action after another, as long as the lesson can be played to its end."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...behaviour import check_scene, operations
from ...geometry.arrays import Floats
from ...scene import ActionData, LessonNode, SceneGraph
from .action_policy import ActionChoice, ActionPolicy, Casting
from .feasibility import unperformed
from .lesson_draft import LessonDraft, UidMaker
from .new_actions import NewAction, make_action, with_actions, with_operation
from .observation import Slots, observe_behaviour
from .roled_actions import read_roled_actions

MOST = 500
"""Actions made in one call, at most."""

ROUNDS = 12
"""Times that it is begun anew without the casts that did not stand the checks."""

Cast = tuple[int, Slots]


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
    other new ones, in the order of the lesson); else the next best cast is tried, at
    last none, and a note says so. What is done in some scenes only is made if ``rng`` draws it, without
    one only if it is done more often than not.
    """
    limits = Casting(policy.kinds).limits(rng)
    banned: dict[Cast, str] = {}
    for _ in range(ROUNDS):
        work = _Work(graph, new, policy, make_uid, limits, banned)
        work.choose()
        scene, bad = work.checked()
        if not bad:
            return Behaviour(scene, work.names(), work.notes)
        banned |= bad
    everyone = {uid: ["no actions: none could be performed"] for uid in new}
    return Behaviour(graph, {}, everyone)


class _Work:
    """One round of :func:`add_behaviour`."""

    def __init__(
        self, graph: SceneGraph, new: Collection[str], policy: ActionPolicy, make_uid: UidMaker,
        limits: Floats, banned: Mapping[Cast, str],
    ) -> None:  # fmt: skip
        self.graph, self.policy, self.make_uid = graph, policy, make_uid
        self.limits, self.banned = limits, banned
        self.kinds, self.casting = policy.kinds, Casting(policy.kinds)
        roled = read_roled_actions(graph)
        self.play = observe_behaviour(graph, self.kinds, new, roled)
        self.draft = LessonDraft(_operation(graph, self.kinds.stage_number), self.kinds, make_uid)
        self.leaf_uids = ["" if roled_action.leaf is None else roled_action.leaf.uid for roled_action in roled]
        self.made: list[NewAction] = []
        self.groups: list[NewAction] = []
        self.casts: list[Cast] = []
        self.notes: dict[str, list[str]] = defaultdict(list)

    def choose(self) -> None:
        """Make actions until the chooser wants no more."""
        blocked: set[int] = set()
        while len(self.made) < MOST and self.casting.anybody(self.play):
            scores = self.policy.scores(self.play)
            scores.wanted[list(blocked)] = 0.0
            choices = self.casting.choices(self.play, scores, self.limits)
            if not choices:
                break
            casts = [choice for choice in choices if choice.kind == choices[0].kind]
            if not any(self._make(choice) for choice in casts):
                blocked.add(casts[0].kind)
        self._add_groups()

    def _make(self, choice: ActionChoice) -> bool:
        """Make the action of a choice unless it is known not to do."""
        kind, rows = self.kinds.kinds[choice.kind], self._rows(choice.slots)
        if (choice.kind, choice.slots) in self.banned:
            return self._note(choice.slots, f"no {kind.name!r}: {self.banned[choice.kind, choice.slots]}")
        uid = self.make_uid(kind.name)
        action = make_action(kind, self.graph, rows, uid)
        if action is None:
            return self._note(choice.slots, f"no {kind.name!r}: no rule tells the right answer")
        leaf, after = "", None
        if kind.stage and not kind.group:
            after = self.policy.after(self.play, choice)
            leaf = self.make_uid("leaf")
            node = LessonNode("action", leaf, action.name, action=uid, optional=kind.optional)
            self.draft.add_leaf(node, kind.stage, self.leaf_uids[after] if after >= 0 else "")
        owner = next(row for row, slot in zip(rows, choice.slots, strict=True) if slot >= 0 and self.play.new[slot])
        self.made.append(NewAction(kind, owner, action, leaf))
        self.casts.append((choice.kind, choice.slots))
        self.leaf_uids.append(leaf)
        stage = self.kinds.stage_number.get(kind.stage, -1)
        self.play = self.play.with_act(choice.kind, choice.slots, stage, after)
        return True

    def _rows(self, slots: Slots) -> Slots:
        target, tool, frame = (int(self.play.rows[slot]) if slot >= 0 else -1 for slot in slots)
        return target, tool, frame

    def _note(self, slots: Slots, text: str) -> bool:
        for uid in self._new_of(slots):
            if text not in self.notes[uid]:
                self.notes[uid].append(text)
        return False

    def _new_of(self, slots: Slots) -> list[str]:
        """Uids of the new objects that play."""
        return [self.graph.uid[self.play.rows[slot]] for slot in slots if slot >= 0 and self.play.new[slot]]

    def names(self) -> dict[str, list[str]]:
        """Names of the actions by uid of the new objects that play in them."""
        found: dict[str, list[str]] = defaultdict(list)
        for roled_action, (_, slots) in zip(self.made, self.casts, strict=True):
            for uid in self._new_of(slots):
                found[uid].append(roled_action.action.name)
        return dict(found)

    def _add_groups(self) -> None:
        """Members of Parallel groups: one new group for all of a name, or leaves beside a group that is there."""
        members: dict[tuple[str, str], list[int]] = defaultdict(list)
        for place, roled_action in enumerate(self.made):
            if roled_action.kind.group:
                members[roled_action.kind.stage, roled_action.kind.group].append(place)
        for (stage, group), places in members.items():
            actions = [self.made[place].action for place in places]
            if len(places) > 1 and not self._has_leaf(stage, group):
                action = ActionData(
                    self.make_uid(group), "Parallel", group, members=tuple(action.uid for action in actions),
                    mode=self.kinds.groups.get(group, "all"), names={action.uid: action.name for action in actions},
                )  # fmt: skip
                first = self.made[places[0]]
                self.groups.append(NewAction(first.kind, first.owner, action, self._last_leaf(stage, action)))
                continue
            for place, action in zip(places, actions, strict=True):
                self.made[place] = replace(self.made[place], leaf=self._last_leaf(stage, action))

    def _has_leaf(self, stage: str, name: str) -> bool:
        found = self.draft.stage_of(stage)
        return found is not None and any(leaf.name == name for leaf in found.children)

    def _last_leaf(self, stage: str, action: ActionData) -> str:
        """Put a leaf at the end of a stage; returns its uid."""
        found, uid = self.draft.stage_of(stage), self.make_uid("leaf")
        last = found.children[-1].uid if found is not None and found.children else ""
        self.draft.add_leaf(LessonNode("action", uid, action.name, action=action.uid), stage, last)
        return uid

    def checked(self) -> tuple[SceneGraph, dict[Cast, str]]:
        """The scene with the new actions and the lesson, and the casts that the checks complain about, with why."""
        if not self.made:
            return self.graph, {}
        scene = with_actions(self.graph, [*self.made, *self.groups])
        tree = self.draft.finished()
        if tree is not None:
            scene = with_operation(scene, tree, self.make_uid("Operation"))
        before = {(problem.uid, problem.message) for problem in check_scene(self.graph)}
        found = [item for item in check_scene(scene) if (item.uid, item.message) not in before]
        why = {item.uid: item.message for item in found if item.severe or tree is not None}
        order = {} if tree is None else {node.action: place for place, node in enumerate(tree.walk())}
        ordered = sorted(
            (roled_action.action for roled_action in self.made), key=lambda action: order.get(action.uid, len(order))
        )
        why = why or unperformed(scene, ordered)
        bad = {
            cast: why.get(roled_action.action.uid, why.get(roled_action.leaf, ""))
            for roled_action, cast in zip(self.made, self.casts, strict=True)
            if roled_action.action.uid in why or (roled_action.leaf and roled_action.leaf in why)
        }
        if why and not bad:  # the complaint is about a stage or group: begin without the last action
            bad = {self.casts[-1]: next(iter(why.values()))}
        return scene, bad


def _operation(graph: SceneGraph, stages: Mapping[str, int]) -> LessonNode | None:
    """The operation with most of the known stages; None in a scene without any."""
    found = operations(graph)
    return max(found, key=lambda tree: sum(node.name in stages for node in tree.walk()), default=None)
