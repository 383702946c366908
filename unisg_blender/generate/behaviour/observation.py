"""A scene as a model of behaviour sees it: its objects as arrays, and the actions that there are already."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...scene import SceneGraph, world_matrices
from ...scene.categories import has_category
from .action_kinds import Kinds
from .roled_actions import RoledAction, read_roled_actions, relation_kinds, support_rows

RELATIONS = ("", "on_top_of", "inside", "hangs_from")
"""How an object is held; others count as the first."""

Slots = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class BehaviourObservation:
    """The objects that may play in actions and what holds them, E of them, and the actions, A of them.

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
    place
        (E, 3): origins in the world, metres.
    below
        bool (E, E): the second hangs below the first in the hierarchy, or is the same.
    kind, slots
        int64 (A,), (A, 3): kind of each action (-1 for others), and which objects are its target, tool and frame (-1).
    leaf_stage, leaf_order
        int64 (A,): stage by the kinds' numbers (-1 for others), and place in it (-1 for members of groups).
    """

    rows: NDArray[np.int64]
    category: NDArray[np.int64]
    new: NDArray[np.bool_]
    support: NDArray[np.int64]
    relation: NDArray[np.int64]
    place: NDArray[np.float64]
    below: NDArray[np.bool_]
    kind: NDArray[np.int64]
    slots: NDArray[np.int64]
    leaf_stage: NDArray[np.int64]
    leaf_order: NDArray[np.int64]

    def with_acts(self, keep: NDArray[np.integer] | NDArray[np.bool_]) -> BehaviourObservation:
        """The same with some of the actions."""
        return replace(
            self, kind=self.kind[keep], slots=self.slots[keep], leaf_stage=self.leaf_stage[keep],
            leaf_order=self.leaf_order[keep],
        )  # fmt: skip

    def with_act(self, kind: int, slots: Slots, stage: int, after: int | None) -> BehaviourObservation:
        """The same with one action more, whose leaf stands behind that of act ``after`` (-1: first; None: no leaf)."""
        order, orders = -1, self.leaf_order
        if after is not None:
            order = 0 if after < 0 else int(self.leaf_order[after]) + 1
            orders = orders + ((self.leaf_stage == stage) & (orders >= order))
        return replace(
            self, kind=np.append(self.kind, kind), slots=np.concatenate([self.slots, np.array([slots], np.int64)]),
            leaf_stage=np.append(self.leaf_stage, stage), leaf_order=np.append(orders, order),
        )  # fmt: skip


def observe_behaviour(
    graph: SceneGraph, kinds: Kinds, new: Collection[str] = (), roled: Iterable[RoledAction] | None = None
) -> BehaviourObservation:
    """The objects and actions of a scene; ``new`` are the uids of the objects that actions are wanted for."""
    above = support_rows(graph)
    rows = _cast(graph, kinds, above)
    number = np.full(len(graph) + 1, -1, np.int64)
    number[rows] = np.arange(len(rows))
    known = {name: place for place, name in enumerate(kinds.categories)}
    codes = np.array([known.get(name, -1) for name in graph.vocabulary] + [-1], np.int64)
    support = number[above[rows]]
    held = relation_kinds(graph)
    relation = np.array([_relation(held.get(row, "")) for row in rows.tolist()], np.int64)
    found = read_roled_actions(graph) if roled is None else list(roled)
    stage = [
        -1 if roled_action.stage is None else kinds.stage_number.get(roled_action.stage.name, -1)
        for roled_action in found
    ]
    wanted = set(new)
    return BehaviourObservation(
        rows=rows,
        category=codes[graph.category[rows]],
        new=np.array([graph.uid[row] in wanted for row in rows.tolist()], bool),
        support=support,
        relation=relation,
        place=world_matrices(graph)[rows, :3, 3],
        below=_below(graph)[np.ix_(rows, rows)],
        kind=np.array([kinds.number_of.get(roled_action.key, -1) for roled_action in found], np.int64),
        slots=number[np.array([roled_action.slots for roled_action in found], np.int64).reshape(-1, 3)],
        leaf_stage=np.array(stage, np.int64),
        leaf_order=np.array(
            [roled_action.order if roled_action.leaf is not None else -1 for roled_action in found], np.int64
        ),
    )


def _cast(graph: SceneGraph, kinds: Kinds, above: NDArray[np.int64]) -> NDArray[np.int64]:
    """Rows of what may play in some kind of action, and of what holds these."""
    names = {name for kind in kinds.kinds for slot in kind.slots for name in slot}
    may = has_category(graph, names)
    may[above[may & (above >= 0)]] = True
    return np.flatnonzero(may)


def _relation(kind: str) -> int:
    return RELATIONS.index(kind) if kind in RELATIONS else 0


def _below(graph: SceneGraph) -> NDArray[np.bool_]:
    """bool (N, N): the second row is the first one or below it."""
    below = np.eye(len(graph), dtype=bool)
    for row, above in enumerate(graph.parent.tolist()):  # parents come first
        if above >= 0:
            below[:, row] |= below[:, above]
    return below


def distances(play: BehaviourObservation) -> NDArray[np.float64]:
    """Distances (E, E) between the objects' origins, metres."""
    return np.linalg.norm(play.place[:, None] - play.place[None], axis=2)
