"""The conditions of a lesson's actions as values of a graph, type by type; what it cannot say is noted.

A value is asked for whole, however little of it decides: so a condition comes in parts, to be asked one after another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..behaviour.fulfilment.action_batch import Batch, make_batch
from ..behaviour.fulfilment.body_contact import EPSILON
from ..behaviour.playing.player import Lesson
from ..geometry.affine_rows import gather, rotation_and_size
from ..geometry.y_up import PLACES, turned_matrices, turned_points
from ..scene.action_data import TYPES
from .behaviour_program import Expression, GraphVariable, Put, real, whole
from .contact_conditions import BodyBox, BoxTest
from .learner_inputs import LearnerInputs
from .pose_conditions import PoseConditions

Alternatives: TypeAlias = list[list[Expression | Put]]
"""Of which one must hold; of each all, the cheap ones first, with what has to be put into variables for the next."""

MOST_ANSWERS = 31
"""An integer of the standard has 32 bits."""


class ActionConditions:
    """The condition of each action; ``lost`` has (name of an action, what the graph says otherwise).

    ``batch`` has the actions as columns.
    """

    def __init__(self, lesson: Lesson, inputs: LearnerInputs) -> None:
        actions, scene = lesson.checks.actions, lesson.graph
        self._boxes = BoxTest()
        self.lost: list[tuple[str, str]] = []
        self._inputs, self._world = inputs, scene.world
        self.batch: Batch = make_batch(scene, actions, range(len(actions)))
        self._mirrored = np.linalg.det(scene.world[:, :3, :3]) < 0
        poses = self.batch.poses
        references = np.tile(np.eye(4), (len(poses.action), 1, 1))
        references[:, :3] = poses.reference.T.reshape(-1, 3, 4)
        self._poses = PoseConditions(self.batch, turned_matrices(references), self._mirrored)

    @property
    def variables(self) -> tuple[GraphVariable, ...]:
        """What conditions need besides what a learner does."""
        return self._boxes.variables if len(self.batch.contacts.action) else ()

    def of(self, task: int) -> Alternatives:
        """When the condition of an action holds, that is no group."""
        action = self.batch.actions[task]
        kinds: Mapping[str, Callable[[int], Alternatives]] = {
            "Insert": self._insert,
            "Remove": self._remove,
            "Use": self._use,
            "Tool": self._tool,
            "Question": self._question,
        }
        if action.type not in TYPES:
            self._lose(task, f"the type {action.type!r} is a user's own: the player asks whether it was done")
            return [[self._inputs.confirmed(task)]]
        if action.type not in ("Use", "Question"):
            self._look_for_shear(task)
        return kinds[action.type](task)

    def _insert(self, task: int) -> Alternatives:
        return [[*self._poses.there(pair)] for pair in self._poses.pairs(task)]

    def _remove(self, task: int) -> Alternatives:
        return [[each] for pair in self._poses.pairs(task) for each in self._poses.away(pair)]

    def _use(self, task: int) -> Alternatives:
        return list(self._contacts(task, self.batch.actions[task].trigger))

    def _tool(self, task: int) -> Alternatives:
        rows = self.batch.poses.row
        posed = list(self._poses.pairs(task))
        found: Alternatives = [
            [*self._handled(task, int(rows[pair]), True), *self._poses.there(pair)] for pair in posed
        ]
        return found or list(self._contacts(task, True))

    def _question(self, task: int) -> Alternatives:
        action = self.batch.actions[task]
        if len(action.answers) > MOST_ANSWERS:
            self._lose(task, f"only {MOST_ANSWERS} of its answers can be told apart")
        right = {place for place in action.correct if place < MOST_ANSWERS}
        return [[self._inputs.chosen(action.uid).equals(whole(sum(1 << place for place in right)))]]

    def _handled(self, task: int, tool: int, trigger: bool) -> Iterator[Expression]:
        """Trigger and force, as far as they are asked for."""
        if trigger:
            yield self._inputs.pressed(tool)
        if self.batch.force[task] > 0:
            yield real(float(self.batch.force[task]) - EPSILON) <= self._inputs.force(tool)

    def _contacts(self, task: int, trigger: bool) -> Iterator[list[Expression | Put]]:
        contacts = self.batch.contacts
        for pair in np.flatnonzero(contacts.action == task).tolist():
            tool, target, distance = (
                int(contacts.tool[pair]),
                int(contacts.target[pair]),
                float(contacts.distance[pair]),
            )
            boxes = self._box(tool, contacts.tool_bounds[:, pair]), self._box(target, contacts.target_bounds[:, pair])
            if distance > 0:
                self._lose(task, "nearness is told by separating axes: at corners it is a little more generous")
            yield [
                *self._handled(task, tool, trigger),
                self._boxes.about(*boxes, distance),
                self._boxes.near,
                self._boxes.touching,
            ]

    def _box(self, row: int, bounds: NDArray[np.float64]) -> BodyBox:
        size = np.linalg.norm(self._world[row, :3, :3], axis=0)
        return BodyBox(row, turned_points(bounds[None, :3])[0], (bounds[3:] * size)[PLACES])

    def _look_for_shear(self, task: int) -> None:
        poses = self.batch.poses
        pairs = list(self._poses.pairs(task))
        if not pairs or not poses.turns[pairs].any():
            return
        rows = np.unique([*poses.row[pairs], *poses.frame[pairs]])
        if not rotation_and_size(gather(self._world, rows[rows >= 0]))[2].all():
            self._lose(task, "something is sheared there: its turn is told by the axes as they are")

    def _lose(self, task: int, text: str) -> None:
        action = self.batch.actions[task]
        self.lost.append((action.name or f"{action.type} {action.uid}", text))
