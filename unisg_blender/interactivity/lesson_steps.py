"""The lesson tree as steps of a graph: what opens, is done, is skipped once something was performed.

The rules are those of :mod:`~..behaviour.lesson.lesson_progress`, told once for each node of the tree: a block that
skips it with all below, one that makes it done, one that looks at it. Blocks call each other. What can never be
skipped, which is most of a tree, has no block for it and is never asked about it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

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

    ``status`` are the variables of its nodes; ``changed`` says that one has changed since :meth:`seen`;
    :meth:`advance` makes the step that moves the lesson on after the leaves for which there are conditions were
    performed. ``restarts``: what is put when a leaf opens, so that its actions start anew.
    """

    def __init__(
        self, outline: Outline, status: NDArray[np.int8],
        restarts: Mapping[int, Sequence[tuple[GraphVariable, Expression]]],
    ) -> None:  # fmt: skip
        self.outline, self._first, self._restarts = outline, status, restarts
        self.status = [GraphVariable(f"status {place}", whole(value)) for place, value in enumerate(status.tolist())]
        self._moved = GraphVariable("moved", NO)
        self.changed = GraphVariable("changed", YES)
        self._at = GraphVariable("changed node", whole(0))
        note = put((self._moved, YES), (self.changed, YES))
        self._tell = {  # steps of the graph that all nodes use
            status: StepBlock([note, Send(event, {"node": self._at.value})]) for status, event in EVENT_OF.items()
        }
        self._skips = [StepBlock() for _ in outline.nodes]
        self._may_skip = _skippable(outline, np.flatnonzero(status == SKIPPED).tolist())
        for place in range(len(outline.nodes)):
            below = [self._skips[other] for other in outline.below(place)]
            steps: list[Step] = [*self._change(place, SKIPPED), *below]
            self._skips[place].steps.append(Branch(self.is_pending(place), StepBlock(steps)))
        self._dones = [self._done(place) for place in range(len(outline.nodes))]

    @property
    def variables(self) -> tuple[GraphVariable, ...]:
        """What the blocks remember."""
        return (*self.status, self._moved, self.changed, self._at)

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
        anew = self._restarts.get(place, ()) if status == OPEN else ()
        return [put((self.status[place], whole(status)), (self._at, whole(place)), *anew), self._tell[status]]

    def seen(self) -> Put:
        """What has changed has been seen."""
        return put((self.changed, NO))

    def _done(self, place: int) -> StepBlock:
        """A node is done; what comes before it and may still be open can no longer be."""
        missed = [self._skips[other] for other in _missed(self.outline, place)]
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
        above = outline.parent[place]
        ready = [self.is_at(other, DONE) for other in [*before[-1:], *needs]]  # the last one opened after the others
        if not before and place:  # what was done before stood below the same part, which has been open then
            ready.insert(0, self.is_at(above, OPEN) | self.is_at(above, DONE))
        opens = Branch(all_of(ready), StepBlock(self._change(place, OPEN)))
        lost = [self.is_at(other, SKIPPED) for other in needs if other in self._may_skip]
        return StepBlock([Branch(any_of(lost), self._skips[place], StepBlock([opens])) if lost else opens])

    def _part(self, place: int) -> StepBlock:
        outline = self.outline
        children = outline.children[place]
        mandatory = [child for child in children if outline.mandatory[child]]
        if mandatory:
            lost = [self.is_at(child, SKIPPED) for child in mandatory if child in self._may_skip]
            done = Branch(all_of(self.is_at(child, DONE) for child in mandatory), self._dones[place])
            return StepBlock([Branch(any_of(lost), self._skips[place], StepBlock([done])) if lost else done])
        settled = StepBlock([self._dones[place]])
        if place and not outline.mandatory[place]:
            some = any_of(self.is_at(child, DONE) for child in children)
            settled = StepBlock([Branch(some, self._dones[place], self._skips[place])])
        return StepBlock([Branch(~any_of(self.is_pending(child) for child in children), settled)])


def _missed(outline: Outline, place: int) -> list[int]:
    """What can no longer be done when a node is: what may be left out and comes before it."""
    found = []
    for sibling in outline.earlier(place):
        for other in (sibling, *outline.below(sibling)):
            chain = [other, *outline.above(other)]
            if not all(outline.mandatory[each] for each in chain[: chain.index(sibling) + 1]):
                found.append(other)
    return found


def _skippable(outline: Outline, first: list[int]) -> set[int]:
    """Nodes that can be skipped: those that are at the start, those that something later skips, and what follows."""
    places = range(len(outline.nodes))
    found = {*first, *(other for place in places for other in _missed(outline, place))}

    def follows(place: int) -> bool:
        """Whether a node can be skipped since its parts, what it waits for, or what it is in can be."""
        mandatory = [child for child in outline.children[place] if outline.mandatory[child]]
        part = place > 0 and outline.nodes[place].kind != "action"
        empty = part and not outline.mandatory[place] and not mandatory
        above = place > 0 and outline.parent[place] in found
        return empty or above or any(other in found for other in (*mandatory, *outline.requires[place]))

    while more := {place for place in places if place not in found and follows(place)}:
        found |= more
    return found
