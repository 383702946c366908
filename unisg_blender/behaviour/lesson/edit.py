"""Edit a lesson tree: every function returns a new tree and leaves the old one alone."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

from ...errors import UniSGError
from ...scene.identity import new_uid
from ...scene.lesson_node import MAY_HOLD, LessonNode


def new_node(kind: str, name: str = "", action: str = "") -> LessonNode:
    """A node with a fresh uid."""
    return LessonNode(kind, new_uid(), name, action)


def find(root: LessonNode, uid: str) -> LessonNode | None:
    """The node with that uid, None if there is none."""
    return next((node for node in root.walk() if node.uid == uid), None)


def parent_of(root: LessonNode, uid: str) -> LessonNode | None:
    """The node above, None for the operation itself."""
    return next((node for node in root.walk() if any(child.uid == uid for child in node.children)), None)


def change(root: LessonNode, uid: str, edit: Callable[[LessonNode], LessonNode]) -> LessonNode:
    """The tree with one node changed by a function.

    Raises
    ------
    UniSGError
        If there is no such node.
    """
    if find(root, uid) is None:
        raise UniSGError(f"the lesson has no node with uid {uid!r}")

    def walk(node: LessonNode) -> LessonNode:
        """The tree with the edited node."""
        if node.uid == uid:
            return edit(node)
        return replace(node, children=tuple(map(walk, node.children)))

    return walk(root)


def insert(root: LessonNode, parent: str, node: LessonNode, place: int | None = None) -> LessonNode:
    """The tree with a node put below another one, at the end when no place is given.

    Raises
    ------
    UniSGError
        If that node cannot hold it.
    """

    def add(above: LessonNode) -> LessonNode:
        """The node with the new one among its children."""
        if node.kind not in MAY_HOLD[above.kind]:
            raise UniSGError(f"{article(above.kind)} {above.kind} cannot hold {article(node.kind)} {node.kind}")
        at = len(above.children) if place is None else place
        return replace(above, children=(*above.children[:at], node, *above.children[at:]))

    return change(root, parent, add)


def article(word: str) -> str:
    """ "a" or "an"."""
    return "an" if word[0] in "aeiou" else "a"


def remove(root: LessonNode, uid: str) -> LessonNode:
    """The tree without a node and all below it; nothing requires these any more.

    Raises
    ------
    UniSGError
        If it is the operation, or not there.
    """
    gone = find(root, uid)
    if gone is None or root.uid == uid:
        raise UniSGError(
            "the operation itself cannot be removed" if gone else f"the lesson has no node with uid {uid!r}"
        )
    return _without_requirements(_cut(root, uid), {node.uid for node in gone.walk()})


def _cut(root: LessonNode, uid: str) -> LessonNode:
    return replace(root, children=tuple(_cut(child, uid) for child in root.children if child.uid != uid))


def _without_requirements(node: LessonNode, uids: set[str]) -> LessonNode:
    return replace(
        node,
        requires=tuple(uid for uid in node.requires if uid not in uids),
        children=tuple(_without_requirements(child, uids) for child in node.children),
    )


def move(root: LessonNode, uid: str, step: int) -> LessonNode:
    """The tree with a node one place up (``step`` -1) or down (+1), into the neighbouring part at the end of its own.

    Unchanged where there is no further to go.
    """
    node, above = find(root, uid), parent_of(root, uid)
    if node is None or above is None:
        return root
    place = [child.uid for child in above.children].index(uid) + step
    if 0 <= place < len(above.children):
        return insert(_cut(root, uid), above.uid, node, place)
    holders = [each for each in root.walk() if node.kind in MAY_HOLD[each.kind] and find(node, each.uid) is None]
    at = [each.uid for each in holders].index(above.uid) + step
    if not 0 <= at < len(holders):
        return root
    return insert(_cut(root, uid), holders[at].uid, node, None if step < 0 else 0)


def nest(root: LessonNode, uid: str) -> LessonNode:
    """The tree with a node put at the end of the sibling before it; unchanged where that cannot hold it."""
    node, above = find(root, uid), parent_of(root, uid)
    if node is None or above is None:
        return root
    place = [child.uid for child in above.children].index(uid)
    if place == 0 or node.kind not in MAY_HOLD[above.children[place - 1].kind]:
        return root
    return insert(_cut(root, uid), above.children[place - 1].uid, node)


def lift(root: LessonNode, uid: str) -> LessonNode:
    """The tree with a node put behind the one that holds it; unchanged where that is not possible."""
    node, above = find(root, uid), parent_of(root, uid)
    outer = parent_of(root, above.uid) if above is not None else None
    if node is None or above is None or outer is None or node.kind not in MAY_HOLD[outer.kind]:
        return root
    place = [child.uid for child in outer.children].index(above.uid) + 1
    return insert(_cut(root, uid), outer.uid, node, place)


def without_leaves(operation: LessonNode, gone: Collection[str]) -> LessonNode:
    """The tree without the leaves of some actions, parts left empty, and requirements of what is gone."""

    def cut(node: LessonNode) -> LessonNode:
        """The node without leaves of lost actions and what is empty then."""
        below = [cut(child) for child in node.children if child.action not in gone or child.kind != "action"]
        return replace(node, children=tuple(child for child in below if child.kind == "action" or child.children))

    tree = cut(operation)
    left = {node.uid for node in tree.walk()}

    def kept(node: LessonNode) -> LessonNode:
        """The node with only those prerequisites that are left."""
        needs = tuple(uid for uid in node.requires if uid in left)
        return replace(node, requires=needs, children=tuple(kept(child) for child in node.children))

    return kept(tree)
