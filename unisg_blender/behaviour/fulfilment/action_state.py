"""The state of actions, each with its own, and one step of time.

An action is performed once its condition has held for ``hold`` seconds without a
break, ``hits`` times (once, if no number is given). Performed actions stay so.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...scene.action_data import ActionData
from ...scene.graph import SceneGraph
from ..lesson.action_places import all_actions
from .action_batch import Batch, make_batch
from .body_contact import EPSILON
from .conditions import CONDITIONS, Condition
from .custom_types import OWN_CONDITIONS
from .snapshot import Moment


@dataclass(frozen=True, eq=False)
class Group:
    """A Parallel action: its place, the places of its members, and whether any of them is enough."""

    index: int
    members: NDArray[np.int64]
    any: bool


@dataclass(frozen=True, eq=False)
class Checks:
    """Actions made ready to be checked, A in number.

    ``batches`` pair the condition of a type with its actions; ``groups`` stand inner
    ones first; ``hold`` float64 (A,) in seconds and ``hits`` float64 (A,);
    ``unknown`` are the places of actions of a type for which there is no condition:
    they are never performed.
    """

    actions: tuple[ActionData, ...]
    batches: tuple[tuple[Condition, Batch], ...]
    groups: tuple[Group, ...]
    hold: NDArray[np.float64]
    hits: NDArray[np.float64]
    unknown: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class ActionState:
    """The state of A actions at a time; arrays (A,).

    Attributes
    ----------
    active
        bool: may be performed now.
    met
        bool: the condition holds.
    since
        float64: time in seconds since when it has held; NaN where it does not.
    counted
        bool: this time of holding has been counted as a hit.
    hits
        int64: how often it has held for long enough.
    done
        bool: performed.
    """

    active: NDArray[np.bool_]
    met: NDArray[np.bool_]
    since: NDArray[np.float64]
    counted: NDArray[np.bool_]
    hits: NDArray[np.int64]
    done: NDArray[np.bool_]


def compile_actions(
    graph: SceneGraph,
    *,
    actions: Sequence[ActionData] | None = None,
    members: Sequence[Sequence[int]] | None = None,
    conditions: Mapping[str, Condition] | None = None,
) -> Checks:
    """Make actions ready to be checked.

    Parameters
    ----------
    actions, members
        The actions instead of all of the scene, which may repeat, and for each the places of
        its members in that list; members are found by uid when omitted.
    conditions
        Types of your own, ``{"Lift": lift}``, besides those of :mod:`.custom_types`: see :mod:`.conditions`.
    """
    actions = all_actions(graph) if actions is None else actions
    if members is None:
        place_of = {action.uid: place for place, action in reversed(list(enumerate(actions)))}
        members = [[place_of[uid] for uid in action.members if uid in place_of] for action in actions]
    known = {**CONDITIONS, **OWN_CONDITIONS, **(conditions or {})}
    places: dict[str, list[int]] = {}
    for place, action in enumerate(actions):
        places.setdefault(action.type, []).append(place)
    batches = [
        (known[kind], make_batch(graph, [actions[place] for place in found], found))
        for kind, found in places.items()
        if kind in known
    ]
    unknown = [place for kind, found in places.items() if kind not in known and kind != "Parallel" for place in found]
    limits = [action.thresholds for action in actions]
    return Checks(
        actions=tuple(actions),
        batches=tuple(batches),
        groups=tuple(_inner_first(actions, members)),
        hold=np.array([limit.hold or 0.0 for limit in limits]),
        hits=np.array([max(limit.hits or 1, 1) for limit in limits], np.float64),
        unknown=tuple(unknown),
    )


def _inner_first(actions: Sequence[ActionData], members: Sequence[Sequence[int]]) -> list[Group]:
    """The Parallel groups, members before what they belong to; groups in a circle in any order."""
    groups: list[Group] = []
    entered: set[int] = set()
    pending = [(place, False) for place, action in enumerate(actions) if action.type == "Parallel"][::-1]
    while pending:
        place, ready = pending.pop()
        if ready:
            groups.append(Group(place, np.array(members[place], np.int64), actions[place].mode == "any"))
        elif place not in entered:
            entered.add(place)
            pending.append((place, True))
            pending += [(member, False) for member in members[place] if actions[member].type == "Parallel"]
    return groups


def start(checks: Checks) -> ActionState:
    """The state before the first moment: nothing active, nothing done."""
    count = len(checks.actions)
    no = np.zeros(count, bool)
    return ActionState(no, no, np.full(count, np.nan), no, np.zeros(count, np.int64), no)


def holds(checks: Checks, moment: Moment) -> NDArray[np.bool_]:
    """Which conditions hold at a moment, whatever was before; bool (A,). Parallel groups have none of their own."""
    met = np.zeros(len(checks.actions), bool)
    for condition, batch in checks.batches:
        met[batch.index] = condition(batch, moment)
    return met


def step(checks: Checks, state: ActionState, moment: Moment, active: NDArray[np.bool_] | None = None) -> ActionState:
    """The state at a later moment.

    Parameters
    ----------
    active
        bool (A,): the actions that may be performed now, all when omitted; members of
        an active Parallel group are active with it. An action that becomes active
        starts anew: what it did before does not count. Inactive ones are watched
        (``met``, ``hits``), never performed.
    """
    active = np.ones(len(checks.actions), bool) if active is None else active.copy()
    for group in reversed(checks.groups):
        active[group.members] |= active[group.index]
    met = holds(checks, moment)
    before = state.met & ~(active & ~state.active)  # what has just become active starts anew
    since = np.where(met, np.where(before, state.since, moment.time), np.nan)
    counted = state.counted & met & before
    hits: NDArray[np.int64] = np.where(active & ~state.active, 0, state.hits)
    enough = met & ~counted & (moment.time - since >= checks.hold - EPSILON)
    hits = hits + enough.astype(np.int64)
    done = state.done | (active & (hits >= checks.hits))
    for group in checks.groups:
        if len(group.members) and active[group.index]:
            performed = done[group.members]
            done[group.index] |= performed.any() if group.any else performed.all()
    return replace(state, active=active, met=met, since=since, counted=counted | enough, hits=hits, done=done)
