"""Which actions a tick has to look at: a condition can only have changed where something about it has.

A tick asks each entity whether it is where it was; what has moved, what the learner did, and a lesson that went on make
actions *stale*, and a graph in which nothing is stale sleeps.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from ..behaviour.fulfilment.action_batch import Batch
from .behaviour_program import NO, YES, Branch, Expression, GraphVariable, Put, Step, StepBlock, any_of, constant, put
from .pose_conditions import carried

SPOT = np.array([0.31, 0.53, 0.79, 1.0])
"""A point in an entity's frame that stays where it is under no turn that anybody makes."""


class Attention:
    """The variables that say what is stale, for some tasks (places of actions)."""

    def __init__(self, batch: Batch, tasks: Iterable[int]) -> None:
        self._awake = GraphVariable("awake", YES)
        self._stale = {task: GraphVariable(f"stale {task}", YES) for task in tasks}
        self._about: dict[int, set[int]] = {}
        poses, contacts = batch.poses, batch.contacts
        for actions, rows in (
            (poses.action, poses.row), (poses.action, poses.frame),
            (contacts.action, contacts.tool), (contacts.action, contacts.target),
        ):  # fmt: skip
            for task, row in zip(actions.tolist(), rows.tolist(), strict=True):
                if row >= 0 and task in self._stale:
                    self._about.setdefault(row, set()).add(task)
        self._seen = {row: GraphVariable(f"seen {row}", constant("float4", *[0.0] * 4)) for row in sorted(self._about)}

    @property
    def variables(self) -> tuple[GraphVariable, ...]:
        """What is remembered."""
        return (self._awake, *self._stale.values(), *self._seen.values())

    def waking(self, tasks: Iterable[int]) -> list[tuple[GraphVariable, Expression]]:
        """What has to be put so that the next look is at some tasks."""
        return [(self._awake, YES), *((self._stale[task], YES) for task in sorted(tasks) if task in self._stale)]

    def about(self, row: int) -> set[int]:
        """Tasks that are about an entity."""
        return self._about.get(row, set())

    def wake_all(self) -> Put:
        """All have to be looked at."""
        return put(*self.waking(self._stale))

    def movements(self) -> Iterator[Step]:
        """Wake what is about entities that have moved since the last look."""
        for row, seen in self._seen.items():
            now = carried(row, SPOT)
            moved = put((seen, now), *self.waking(self._about[row]))
            yield Branch(seen.value.equals(now), StepBlock(), StepBlock([moved]))

    def looks(self, task: int, late: Expression, look: StepBlock) -> Branch:
        """Look at a task if it is stale, or ``late``: something other than what is told here calls for it."""
        return Branch(any_of([self._stale[task].value, late]), look)

    def rest(self) -> Put:
        """Nothing is stale: all was looked at."""
        return put(*((stale, NO) for stale in self._stale.values()))

    def awake(self, steps: list[Step]) -> Branch:
        """Do something only if anything is stale."""
        return Branch(self._awake.value, StepBlock([put((self._awake, NO)), *steps]))
