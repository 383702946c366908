"""Nodes of a lesson that wait for each other, so that nobody can ever begin."""

from __future__ import annotations

from collections.abc import Iterator

from ..lesson.lesson_progress import DONE, OPEN, advance, first_status
from ..lesson.lesson_tree import Outline


def circles(plan: Outline) -> Iterator[tuple[str, int]]:
    """Messages about nodes that can never be reached, each with a node's place.

    Every node has a beginning, an end and a last moment; each rule of the lesson (see
    :mod:`..lesson.lesson_progress`) says which of these comes before which. What is left when
    everything that waits for nothing is taken away again and again (Kahn 1962)
    stands in a circle, or waits for one.
    """
    after = _after(plan)
    waits = [0] * len(after)
    for later in after:
        for node in later:
            waits[node] += 1
    ready = [node for node, count in enumerate(waits) if not count]
    while ready:
        for node in after[ready.pop()]:
            waits[node] -= 1
            if not waits[node]:
                ready.append(node)
    stuck = {node for node, count in enumerate(waits) if count}
    if not stuck:
        return
    circle = _circle(after, stuck)
    names = list(dict.fromkeys(plan.label(node // 3) for node in circle))
    yield f"{', '.join(names)} wait for each other: none of them can begin", circle[0] // 3
    held = {node // 3 for node in stuck if node % 3 == 0} - {node // 3 for node in circle}
    for place in sorted(held):
        if plan.nodes[place].kind == "action":
            yield f"{plan.label(place)} can never be reached", place


def unreached(plan: Outline) -> list[int]:
    """Leaves that are skipped or never open when one action after another is done, optional ones first.

    Without :func:`circles` these are optional: such as one that must come before a
    part is done, and requires everything in that part.
    """
    status, _ = advance(plan, first_status(plan), ())
    leaves = [place for place, node in enumerate(plan.nodes) if node.kind == "action"]
    while ready := [place for place in leaves if status[place] == OPEN]:
        chosen = min(ready, key=lambda place: all(plan.mandatory[each] for each in (place, *plan.above(place))))
        status, _ = advance(plan, status, [chosen])
    return [place for place in leaves if status[place] != DONE]


def _after(plan: Outline) -> list[list[int]]:
    """What comes after what: of place p, 3 p is the beginning, 3 p + 1 the end, 3 p + 2 the last of all inside it."""
    after: list[list[int]] = [[] for _ in range(3 * len(plan.nodes))]
    for place in range(len(plan.nodes)):
        begin, end, last = 3 * place, 3 * place + 1, 3 * place + 2
        after[begin].append(end)
        after[end].append(last)
        above = plan.parent[place]
        if above >= 0:
            after[3 * above].append(begin)
            after[last].append(3 * above + 2)
            if plan.mandatory[place] or not any(plan.mandatory[child] for child in plan.children[above]):
                after[end].append(3 * above + 1)
        earlier = plan.earlier(place)
        if earlier:
            after[3 * earlier[-1] + 2].append(end)  # what is not done by then is skipped
            mandatory = [sibling for sibling in earlier if plan.mandatory[sibling]]
            if mandatory:
                after[3 * mandatory[-1] + 1].append(begin)
        for wanted in plan.requires[place]:
            after[3 * wanted + 1].append(begin)
    return after


def _circle(after: list[list[int]], stuck: set[int]) -> list[int]:
    """One circle among the stuck nodes, in the order of waiting."""
    before: dict[int, int] = {}
    for node in sorted(stuck):
        for later in after[node]:
            if later in stuck:
                before.setdefault(later, node)
    node, seen = next(iter(before)), list[int]()
    while node not in seen:
        seen.append(node)
        node = before[node]
    return seen[seen.index(node) :][::-1]
