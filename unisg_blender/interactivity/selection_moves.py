"""Where nothing can be dragged, selecting a thing does with it what an open action asks for.

``event/onSelect`` of KHR_node_selectability: an Insert's target goes to its reference pose, a Remove's away, a tool to
its target and back with its trigger pressed; what needs confirming is confirmed. Places are those of the start: where a
frame or a target has moved since, things go where it was. One selection at a time; a page that lets things be dragged
sends ``unisg:dragging`` {possible}, and selecting does nothing then.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..behaviour.fulfilment.action_batch import Batch
from ..geometry.affine_rows import rotation_and_size
from ..geometry.y_up import turned_matrices
from ..poses.rotations import quaternion_from_rotation
from ..scene import SceneGraph
from ..scene.action_data import TYPES
from .attention import Attention
from .behaviour_program import (
    NO,
    YES,
    Branch,
    Expression,
    GraphEvent,
    GraphVariable,
    Interpolate,
    Put,
    Start,
    Step,
    StepBlock,
    all_of,
    constant,
    put,
    real,
    received,
    whole,
)
from .learner_inputs import LearnerInputs

DRAGGING = GraphEvent("unisg:dragging", {"possible": "bool"})
GOING, LONGER, LIFTED = 0.5, 0.3, 0.3
"""Seconds of a way, seconds that a tool stays longer than it has to be held, metres that a removed thing is lifted."""


class Move(NamedTuple):
    """Where a row goes for a task: translation (3,) and rotation x, y, z, w (4,) in its parent, glTF's axes.

    ``stay``: seconds after which it comes back; 0: it stays there.
    """

    task: int
    row: int
    translation: NDArray[np.float64]
    rotation: NDArray[np.float64]
    stay: float


class SelectionMoves:
    """What selecting does, for the tasks of a batch."""

    def __init__(
        self, scene: SceneGraph, batch: Batch, inputs: LearnerInputs, attention: Attention,
        node_of: Callable[[int], int],
    ) -> None:  # fmt: skip
        self._scene, self._batch, self._inputs, self._attention = scene, batch, inputs, attention
        self._node_of = node_of
        self._off, self._busy = GraphVariable("dragging", NO), GraphVariable("selection moves", NO)
        self._node = GraphVariable("selected", whole(0))
        self._stay = GraphVariable("stay", real(0))
        origin, turn = constant("float3", 0.0, 0.0, 0.0), constant("float4", 0.0, 0.0, 0.0, 1.0)
        self._there = GraphVariable("goal", origin), GraphVariable("goal turn", turn)
        self._home = GraphVariable("home", origin), GraphVariable("home turn", turn)

    @property
    def variables(self) -> tuple[GraphVariable, ...]:
        """What is remembered."""
        return (self._off, self._busy, self._node, self._stay, *self._there, *self._home)

    def starts(self, tasks: list[int], may: Callable[[int], Expression]) -> list[Start]:
        """What happens when a thing is selected, for those of some tasks that ``may`` be performed."""
        choices: dict[int, list[tuple[int, StepBlock]]] = {}
        going = self._going()
        for task in tasks:
            if self._batch.actions[task].type not in TYPES:
                for row in self._targets(task):
                    confirms = StepBlock([self._inputs.confirming(task, self._attention)])
                    choices.setdefault(row, []).append((task, confirms))
            for move in self._moves(task):
                choices.setdefault(move.row, []).append((task, StepBlock([self._begins(move), going])))
        free = all_of([~self._off.value, ~self._busy.value])
        starts = [Start("event/receive", StepBlock([put((self._off, received(DRAGGING, "possible")))]), event=DRAGGING)]
        for row, found in sorted(choices.items()):
            choice = StepBlock()
            for task, block in reversed(found):
                choice = StepBlock([Branch(may(task), block, choice)])
            starts.append(Start("event/onSelect", StepBlock([Branch(free, choice)]), node=row))
        return starts

    def _targets(self, task: int) -> list[int]:
        return [self._scene.row_of_uid[uid] for uid in self._batch.actions[task].targets]

    def _begins(self, move: Move) -> Put:
        """All that the way of a thing needs, and the trigger pressed."""
        force = float(self._batch.force[move.task]) if move.stay else None
        return put(
            (self._node, whole(self._node_of(move.row))),
            *([(self._stay, real(move.stay))] if move.stay else []),
            (self._there[0], constant("float3", *move.translation.tolist())),
            (self._there[1], constant("float4", *move.rotation.tolist())),
            *self._inputs.handling(move.row, force, self._attention),
        )  # fmt: skip

    def _going(self) -> StepBlock:
        """There; and where it does not stay, back again and the trigger released."""
        back = [
            put(*self._inputs.releasing(self._attention), (self._stay, real(0))),
            *self._way(self._home, real(GOING), StepBlock([put((self._busy, NO))])),
        ]
        waits = StepBlock([self._one(1, self._there, self._stay.value, StepBlock(back))])
        arrived = StepBlock([Branch(self._stay.value > real(0), waits, StepBlock([put((self._busy, NO))]))])
        now = tuple(Expression(each.initial.kind, "pointer/get", {"n": self._node.value}, _pointer(k, each))
                    for k, each in enumerate(self._home))  # fmt: skip
        begins = put((self._busy, YES), *zip(self._home, now, strict=True))
        return StepBlock([begins, *self._way(self._there, real(GOING), arrived)])

    def _way(self, goal: tuple[GraphVariable, GraphVariable], seconds: Expression, then: StepBlock) -> list[Step]:
        return [self._one(0, goal, seconds, StepBlock()), self._one(1, goal, seconds, then)]

    def _one(self, k: int, goal: tuple[GraphVariable, ...], seconds: Expression, then: StepBlock) -> Interpolate:
        return Interpolate(_pointer(k, goal[k]), self._node.value, goal[k].value, seconds, then)

    def _moves(self, task: int) -> Iterator[Move]:
        """What moves for a task, as it is from the start."""
        batch, world = self._batch, self._scene.world
        action = batch.actions[task]
        pairs = np.flatnonzero(batch.poses.action == task)
        contacts = np.flatnonzero(batch.contacts.action == task)
        stay = float(batch.hold[task]) + LONGER if action.type in ("Use", "Tool") else 0.0
        for pair in pairs.tolist():
            row, frame = int(batch.poses.row[pair]), int(batch.poses.frame[pair])
            goal = np.vstack([batch.poses.reference[:, pair].reshape(3, 4), [0, 0, 0, 1]])
            if action.type == "Remove":
                goal = _away(world[row], float(batch.distance[task]), float(batch.angle[task]))
            elif frame >= 0:
                goal = world[frame] @ goal
            yield self._move(task, row, goal, stay)
        if not len(pairs) and len(contacts):
            pair = int(contacts[0])
            tool, target = int(batch.contacts.tool[pair]), int(batch.contacts.target[pair])
            goal = world[tool].copy()
            middles = batch.contacts.target_bounds[:3, pair], batch.contacts.tool_bounds[:3, pair]
            goal[:3, 3] += _placed(world[target], middles[0]) - _placed(world[tool], middles[1])
            yield self._move(task, tool, goal, stay)

    def _move(self, task: int, row: int, goal: NDArray[np.float64], stay: float) -> Move:
        parent = int(self._scene.parent[row])
        local = goal if parent < 0 else np.linalg.inv(self._scene.world[parent]) @ goal
        turned = turned_matrices(local[None])[0]
        rotation = rotation_and_size(np.ascontiguousarray(turned[:3].reshape(12, 1)))[0]
        w, x, y, z = quaternion_from_rotation(tuple(rotation.reshape(3, 3, -1).transpose(1, 0, 2).reshape(9, -1)))
        return Move(task, row, turned[:3, 3], np.array([x, y, z, w]).ravel(), stay)


def _placed(world: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
    return world[:3, :3] @ point + world[:3, 3]


def _away(world: NDArray[np.float64], distance: float, angle: float) -> NDArray[np.float64]:
    """Farther than a distance, or else turned by more than an angle."""
    goal = world.copy()
    goal[2, 3] += max(LIFTED, 2 * distance) if np.isfinite(distance) else 0.0
    if not np.isfinite(distance):
        turn = min(2 * angle, np.pi)
        c, s = np.cos(turn), np.sin(turn)
        goal[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ goal[:3, :3]
    return goal


def _pointer(k: int, of: GraphVariable) -> dict[str, str | int]:
    return {"pointer": f"/nodes/[n]/{('translation', 'rotation')[k]}", "type": of.initial.kind}
