"""A lesson tree as arrays: who is below whom, who waits for whom, and what cannot be left out."""

from __future__ import annotations

from dataclasses import dataclass

from ...scene.lesson_node import LessonNode


@dataclass(frozen=True)
class Outline:
    """The nodes of one operation, depth first; node 0 is the operation.

    Attributes
    ----------
    nodes
        The nodes.
    parent
        Place of the node above, -1 for the operation.
    children, requires
        Places of the nodes below, and of those that must be done before; what is
        required and not in the tree is left out.
    mandatory
        Whether the node must be done for the one above to be done. Something
        optional becomes mandatory where something mandatory requires it; a part in
        which everything is optional is optional itself.
    """

    nodes: tuple[LessonNode, ...]
    parent: tuple[int, ...]
    children: tuple[tuple[int, ...], ...]
    requires: tuple[tuple[int, ...], ...]
    mandatory: tuple[bool, ...]

    def above(self, place: int) -> list[int]:
        """The nodes above a node, nearest first."""
        found = []
        while (place := self.parent[place]) >= 0:
            found.append(place)
        return found

    def below(self, place: int) -> list[int]:
        """The nodes below a node, at any depth."""
        found, pending = [], list(self.children[place])
        while pending:
            found.append(pending.pop())
            pending += self.children[found[-1]]
        return found

    def earlier(self, place: int) -> tuple[int, ...]:
        """The siblings that come before a node, if their order is fixed."""
        above = self.parent[place]
        if above < 0 or not self.nodes[above].ordered:
            return ()
        siblings = self.children[above]
        return siblings[: siblings.index(place)]

    def label(self, place: int) -> str:
        """What to call a node in a message: "stage 'Incision'"."""
        node = self.nodes[place]
        return f"{node.kind} {(node.name or node.uid)!r}"


def outline(operation: LessonNode) -> Outline:
    """Lay out an operation; of nodes that share a uid, requirements mean the first."""
    nodes: list[LessonNode] = []
    parent: list[int] = []
    pending = [(operation, -1)]
    while pending:
        node, above = pending.pop()
        place = len(nodes)
        nodes.append(node)
        parent.append(above)
        pending += [(child, place) for child in reversed(node.children)]
    children: list[list[int]] = [[] for _ in nodes]
    for place, above in enumerate(parent):
        if above >= 0:
            children[above].append(place)
    place_of = {node.uid: place for place, node in reversed(list(enumerate(nodes)))}
    requires = [tuple(place_of[uid] for uid in node.requires if uid in place_of) for node in nodes]
    return Outline(
        nodes=tuple(nodes),
        parent=tuple(parent),
        children=tuple(map(tuple, children)),
        requires=tuple(requires),
        mandatory=tuple(_mandatory(nodes, parent, children, requires)),
    )


def _mandatory(
    nodes: list[LessonNode], parent: list[int], children: list[list[int]], requires: list[tuple[int, ...]]
) -> list[bool]:
    must = [not node.optional for node in nodes]
    for place in reversed(range(len(nodes))):  # from the leaves up
        if nodes[place].kind != "action":
            must[place] &= any(must[child] for child in children[place])
    must[0] = True
    visited: set[int] = set()
    pending = [0]
    while pending:  # what the operation cannot do without
        place = pending.pop()
        if place in visited:
            continue
        visited.add(place)
        must[place] = True
        needed = [child for child in children[place] if must[child]]
        if not needed and place != 0:
            needed = children[place]
        for wanted in requires[place]:
            needed = [*needed, wanted]
            while wanted > 0:
                wanted = parent[wanted]
                needed.append(wanted)
        for found in needed:
            must[found] = True
            pending.append(found)
            if parent[found] in visited:  # it may have gained a child that it cannot do without
                must[parent[found]] = True
    return must
