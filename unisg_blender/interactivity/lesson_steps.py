"""The lesson tree as steps of a graph: what opens, is done, is skipped once something was performed.

The rules are those of :mod:`~..behaviour.lesson.lesson_progress`, told once for each node of the tree: a block that
skips it with all below, one that makes it done, one that looks at it. Blocks call each other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..behaviour.lesson.lesson_progress import DONE, OPEN, SKIPPED, WAITING
from ..behaviour.lesson.lesson_tree import Outline
from .behaviour_program import (
    NO,
    YES,
    Branch,
    Expression,
    GraphEvent,
    GraphVariable,
    Put,
    Send,
    Step,
    StepBlock,
    While,
    all_of,
    any_of,
    put,
    whole,
)

STARTED = GraphEvent("unisg:started", {"node": "int"})
PERFORMED = GraphEvent("unisg:performed", {"node": "int"})
MISSED = GraphEvent("unisg:skipped", {"node": "int"})

EVENT_OF = {OPEN: STARTED, DONE: PERFORMED, SKIPPED: MISSED}


class LessonSteps:
    """The blocks and variables of one lesson tree.

    ``status`` are the variables of its nodes; ``changed`` says that one has changed, and ``opened`` which leaves
    have opened, since :meth:`seen`; :meth:`advance` makes the step that moves the lesson on after the leaves
    for which there are conditions were performed.
    """

    def __init__(self, outline: Outline, status: NDArray[np.int8]) -> None:
        self.outline, self._first = outline, status
        self.status = [GraphVariable(f"status {place}", whole(value)) for place, value in enumerate(status.tolist())]
        self.opened = {
            place: GraphVariable(f"opened {place}", YES if status[place] == OPEN else NO)
            for place, node in enumerate(outline.nodes)
            if node.kind == "action"
        }
        self._moved = GraphVariable("moved", NO)
        self.changed = GraphVariable("changed", YES)
        self._at = GraphVariable("changed node", whole(0))
        note = put((self._moved, YES), (self.changed, YES))
        self._tell = {  # steps of the graph that all nodes use
            status: StepBlock([note, Send(event, {"node": self._at.value})]) for status, event in EVENT_OF.items()
        }
        self._skips = [StepBlock() for _ in outline.nodes]
        self._may_skip = _may_be_skipped(outline)
        for place in range(len(outline.nodes)):
            below = [self._skips[other] for other in outline.below(place)]
            steps: list[Step] = [*self._change(place, SKIPPED), *below]
            self._skips[place].steps.append(Branch(self.is_pending(place), StepBlock(steps)))
        self._dones = [self._done(place) for place in range(len(outline.nodes))]

    @property
    def variables(self) -> tuple[GraphVariable, ...]:
        """What the blocks remember."""
        return (*self.status, *self.opened.values(), self._moved, self.changed, self._at)

    def is_at(self, place: int, status: int) -> Expression:
        """Whether a node has a status."""
        return self.status[place].value.equals(whole(status))

    def is_pending(self, place: int) -> Expression:
        """Whether a node waits or is open."""
        return self.status[place].value <= whole(OPEN)

    def began(self) -> StepBlock:
        """Tell what is open at the start."""
        opened = np.flatnonzero(self._first == OPEN).tolist()
        return StepBlock([Send(STARTED, {"node": whole(place)}) for place in opened])

    def advance(self, performed: dict[int, Expression]) -> StepBlock:
        """Make the open leaves done whose conditions hold, then all that follows from it."""
        leaves = [
            Branch(self.is_at(place, OPEN) & condition, self._dones[place]) for place, condition in performed.items()
        ]
        looks = [self._look(place) for place in range(len(self.outline.nodes))]
        return StepBlock([*leaves, While(self._moved.value, StepBlock([put((self._moved, NO)), *looks]))])

    def _change(self, place: int, status: int) -> list[Step]:
        opened = [(self.opened[place], YES)] if status == OPEN and place in self.opened else []
        return [put((self.status[place], whole(status)), (self._at, whole(place)), *opened), self._tell[status]]

    def seen(self) -> Put:
        """What has opened, and changed, has been seen."""
        return put((self.changed, NO), *((opened, NO) for opened in self.opened.values()))

    def _done(self, place: int) -> StepBlock:
        """A node is done; what comes before it and may still be open can no longer be."""
        outline, missed = self.outline, []
        for sibling in outline.earlier(place):
            for other in (sibling, *outline.below(sibling)):
                chain = [other, *outline.above(other)]
                if not all(outline.mandatory[each] for each in chain[: chain.index(sibling) + 1]):
                    missed.append(self._skips[other])
        return StepBlock([*self._change(place, DONE), *missed])

    def _look(self, place: int) -> StepBlock:
        """What becomes of a node that waits, or of a part that is open."""
        waits = Branch(self.is_at(place, WAITING), self._waiting(place))
        if self.outline.nodes[place].kind == "action":
            return StepBlock([waits])
        return StepBlock([Branch(self.is_at(place, OPEN), self._part(place), StepBlock([waits] if place else []))])

    def _waiting(self, place: int) -> StepBlock:
        outline = self.outline
        needs = outline.requires[place]
        before = [other for other in outline.earlier(place) if outline.mandatory[other]]
        above = self.status[outline.parent[place]].value if place else whole(OPEN)
        ready = all_of(
            [
                above.equals(whole(OPEN)) | above.equals(whole(DONE)),
                *(self.is_at(other, DONE) for other in [*before[-1:], *needs]),  # the last one opened after the others
            ]
        )
        opens = Branch(ready, StepBlock(self._change(place, OPEN)))
        if not needs:
            return StepBlock([opens])
        lost = any_of(self.is_at(other, SKIPPED) for other in needs)
        return StepBlock([Branch(lost, self._skips[place], StepBlock([opens]))])

    def _part(self, place: int) -> StepBlock:
        outline = self.outline
        children = outline.children[place]
        mandatory = [child for child in children if outline.mandatory[child]]
        if mandatory:
            lost = [self.is_at(child, SKIPPED) for child in mandatory if self._may_skip[child]]
            done = Branch(all_of(self.is_at(child, DONE) for child in mandatory), self._dones[place])
            return StepBlock([Branch(any_of(lost), self._skips[place], StepBlock([done])) if lost else done])
        settled = StepBlock([self._dones[place]])
        if place and not outline.mandatory[place]:
            some = any_of(self.is_at(child, DONE) for child in children)
            settled = StepBlock([Branch(some, self._dones[place], self._skips[place])])
        return StepBlock([Branch(~any_of(self.is_pending(child) for child in children), settled)])


def _may_be_skipped(outline: Outline) -> list[bool]:
    """Nodes that can be skipped while what is above them is not: they, or something below, are optional or require."""
    return [
        any(outline.requires[each] or not outline.mandatory[each] for each in (place, *outline.below(place)))
        for place in range(len(outline.nodes))
    ]
