"""A scene as a model of behaviour sees it: its objects as arrays, and the actions that there are already."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays import Bools, Floats, Ints
from ...scene import SceneGraph, world_matrices
from ...scene.categories import category_numbers, has_category
from ...spatial import find_supports
from ...spatial.supports import SUPPORT_KINDS
from .action_kinds import Kinds
from .roled_actions import RoledAction, Slots, read_roled_actions

RELATIONS = ("", *SUPPORT_KINDS)
"""How an object is held, as far as that is told."""


@dataclass(frozen=True, eq=False)
class BehaviourObservation:
    """The objects that may take part in actions and what holds them, E of them, and the actions, A of them.

    Attributes
    ----------
    rows
        int64 (E,): rows in the scenegraph.
    category
        int64 (E,): positions in the categories of the kinds, -1 for others.
    new
        bool (E,): whether an action is wanted for it.
    support, relation
        int64 (E,): which of the objects holds it (-1: none), and how, as in :data:`RELATIONS`.
    position
        (E, 3): origins in the world, metres.
    below
        bool (E, E): the second hangs below the first in the hierarchy, or is the same.
    kind, slots
        int64 (A,), (A, 3): kind of each action (-1 for others), and which objects are its target, tool and frame (-1).
    leaf_stage, leaf_order
        int64 (A,): stage by the kinds' numbers (-1 for others), and place in it (-1 for members of groups).
    """

    rows: Ints
    category: Ints
    new: Bools
    support: Ints
    relation: Ints
    position: Floats
    below: Bools
    kind: Ints
    slots: Ints
    leaf_stage: Ints
    leaf_order: Ints

    def keep_actions(self, keep: NDArray[np.integer] | Bools) -> BehaviourObservation:
        """The same with some of the actions."""
        return replace(
            self, kind=self.kind[keep], slots=self.slots[keep], leaf_stage=self.leaf_stage[keep],
            leaf_order=self.leaf_order[keep],
        )  # fmt: skip

    def with_action(self, kind: int, slots: Slots, stage: int, after: int | None) -> BehaviourObservation:
        """The same with one action more, its leaf behind that of action ``after`` (-1: first; None: no leaf)."""
        order, orders = -1, self.leaf_order
        if after is not None:
            order = 0 if after < 0 else int(self.leaf_order[after]) + 1
            orders = orders + ((self.leaf_stage == stage) & (orders >= order))
        return replace(
            self, kind=np.append(self.kind, kind), slots=np.concatenate([self.slots, np.array([slots], np.int64)]),
            leaf_stage=np.append(self.leaf_stage, stage), leaf_order=np.append(orders, order),
        )  # fmt: skip


def observe_behaviour(
    graph: SceneGraph, kinds: Kinds, new: Collection[str] = (), roled_actions: Iterable[RoledAction] | None = None
) -> BehaviourObservation:
    """The objects and actions of a scene; ``new`` are the uids of the objects that actions are wanted for."""
    supports, wanted = find_supports(graph), set(new)
    above, held = supports.by_row, np.append(supports.first_kind, "")[supports.objects.of_row]
    rows = _participants(graph, kinds, above)
    number = np.full(len(graph) + 1, -1, np.int64)
    number[rows] = np.arange(len(rows))
    actions = list(read_roled_actions(graph) if roled_actions is None else roled_actions)
    relation = [RELATIONS.index(kind) for kind in held[rows]]
    stage = [-1 if roled.stage is None else kinds.stage_number.get(roled.stage.name, -1) for roled in actions]
    return BehaviourObservation(
        rows=rows,
        category=category_numbers(graph, kinds.categories)[rows],
        new=np.array([graph.uid[row] in wanted for row in rows.tolist()], bool),
        support=number[above[rows]],
        relation=np.array(relation, np.int64),
        position=world_matrices(graph)[rows, :3, 3],
        below=_below(graph)[np.ix_(rows, rows)],
        kind=np.array([kinds.number_of.get(roled.key, -1) for roled in actions], np.int64),
        slots=number[np.array([roled.slots for roled in actions], np.int64).reshape(-1, 3)],
        leaf_stage=np.array(stage, np.int64),
        leaf_order=np.array([-1 if roled.leaf is None else roled.order for roled in actions], np.int64),
    )


def _participants(graph: SceneGraph, kinds: Kinds, above: Ints) -> Ints:
    """Rows of what may take part in some kind of action, and of what holds these."""
    names = {name for kind in kinds.kinds for slot in kind.slots for name in slot}
    may = has_category(graph, names)
    may[above[may & (above >= 0)]] = True
    return np.flatnonzero(may)


def _below(graph: SceneGraph) -> Bools:
    """bool (N, N): the second row is the first one or below it."""
    below = np.eye(len(graph), dtype=bool)
    for row, above in enumerate(graph.parent.tolist()):  # parents come first
        if above >= 0:
            below[:, row] |= below[:, above]
    return below
