"""How far a lesson has come: which nodes wait, are open, are done or were skipped.

The rules. A node opens when the one above it is open or done, what it requires is
done and, in a part whose order is fixed, every mandatory sibling before it is done.
A part is done when its mandatory children are (where all are optional: when none is
left). What is optional stays open until, where the order is fixed, something that
comes later is done: then it is skipped, and so is what requires it. So the optional
end of a lesson can still be done when the lesson is.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .lesson_tree import Outline

WAITING, OPEN, DONE, SKIPPED = range(4)
STATUSES = ("waiting", "open", "done", "skipped")


class Change(NamedTuple):
    """A node's new status."""

    place: int
    status: int


def first_status(outline: Outline) -> NDArray[np.int8]:
    """int8 (M,): every node waits, the operation is open."""
    status = np.full(len(outline.nodes), WAITING, np.int8)
    status[0] = OPEN
    return status


def advance(
    outline: Outline, before: NDArray[np.int8], performed: Collection[int]
) -> tuple[NDArray[np.int8], tuple[Change, ...]]:
    """The statuses after the open leaves at the places ``performed`` were performed, and all changes in order.

    ``before`` int8 (M,) are those before.

    Leaves that are not open stay as they are, whatever was performed.
    """
    status: list[int] = before.tolist()  # one by one, numpy's entries take three times as long
    changes: list[Change] = []

    def put(place: int, new: int) -> None:
        """Set a place's status, and skip what can no longer be done."""
        status[place] = new
        changes.append(Change(place, new))
        missed = outline.below(place) if new == SKIPPED else ()
        if new == DONE:
            missed = [other for sibling in outline.earlier(place) for other in (sibling, *outline.below(sibling))]
        for other in missed:
            if status[other] in (WAITING, OPEN):
                put(other, SKIPPED)

    for place in performed:
        if status[place] == OPEN and outline.nodes[place].kind == "action":
            put(place, DONE)
    moved = True
    while moved:
        count = len(changes)
        for place in range(len(outline.nodes)):
            if status[place] == WAITING:
                new = _may_open(outline, status, place)
            elif status[place] == OPEN and outline.nodes[place].kind != "action":
                new = _part_status(outline, status, place)
            else:
                continue
            if new != status[place]:
                put(place, new)
        moved = len(changes) > count
    return np.array(status, np.int8), tuple(changes)


def _may_open(outline: Outline, status: Sequence[int], place: int) -> int:
    needs = [status[wanted] for wanted in outline.requires[place]]
    if SKIPPED in needs:
        return SKIPPED
    before = all(status[sibling] == DONE or not outline.mandatory[sibling] for sibling in outline.earlier(place))
    ready = status[outline.parent[place]] in (OPEN, DONE) and before and all(need == DONE for need in needs)
    return OPEN if ready else WAITING


def _part_status(outline: Outline, status: Sequence[int], place: int) -> int:
    children = outline.children[place]
    mandatory = [status[child] for child in children if outline.mandatory[child]]
    if SKIPPED in mandatory:
        return SKIPPED
    if mandatory:
        return DONE if all(child == DONE for child in mandatory) else OPEN
    settled = [status[child] for child in children]
    if any(child in (WAITING, OPEN) for child in settled):
        return OPEN
    return DONE if DONE in settled or place == 0 or outline.mandatory[place] else SKIPPED


def blockers(outline: Outline, status: NDArray[np.int8], place: int) -> list[int]:
    """What a waiting node waits for: undone requirements and earlier siblings, its own and those of the nodes above."""
    found: list[int] = []
    for node in (place, *outline.above(place)):
        found += [wanted for wanted in outline.requires[node] if status[wanted] != DONE]
        found += [other for other in outline.earlier(node) if outline.mandatory[other] and status[other] != DONE]
    return list(dict.fromkeys(found))
