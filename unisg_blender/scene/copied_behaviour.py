"""What the behaviour of copied objects means: what was copied together belongs together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .action_data import ActionData
from .identity import copies, derived_uid, retarget_copy
from .lesson_node import LessonNode
from .properties import ObjectProperties
from .relation import Relation

SAME_PLACE = 1e-4
"""Metres (and matrix entries) within which two objects stand to each other as their originals do."""


@dataclass(frozen=True, eq=False)
class Copies:
    """The objects of a scene that share a stored uid.

    ``stored`` and ``resolved`` as for :func:`~.identity.resolve_uids`; ``groups``
    are the rows of the copies by that uid, in natural order of their names,
    ``original`` the row of the one that keeps it; ``world`` gives world matrices
    (N, 4, 4) when they are needed.
    """

    stored: Sequence[str]
    resolved: Sequence[str]
    groups: dict[str, list[int]]
    original: dict[str, int]
    world: Callable[[], NDArray[np.float64]]

    def companion(self, row: int, uid: str) -> str:
        """What ``uid`` means to the copied object in ``row``: the copy made together with it, or ``uid`` itself.

        Of several copies it is the one that stands to the object as the original of
        the one stands to the original of the other. Where that tells nothing, and
        both have as many copies, the first belongs with the first, the second with
        the second.
        """
        own = self.groups[self.stored[row]]
        if uid == self.stored[row]:
            return self.resolved[row]
        candidates = self.groups.get(uid)
        if not candidates or uid not in self.original or self.stored[row] not in self.original:
            return uid
        rank = own.index(row)
        if len(own) == len(candidates) == 1:
            return self.resolved[candidates[0]]
        alike = self._standing_alike(row, self.original[uid], candidates)
        if len(alike) == 1:
            return self.resolved[alike[0]]
        if len(own) == len(candidates):
            return self.resolved[candidates[rank]]
        return self.resolved[alike[min(rank, len(alike) - 1)]] if alike else uid

    def _standing_alike(self, row: int, other: int, candidates: list[int]) -> list[int]:
        world = self.world()
        origin = self.original[self.stored[row]]
        expected = world[row] @ np.linalg.pinv(world[origin]) @ world[other]
        return [each for each in candidates if np.allclose(world[each], expected, rtol=0, atol=SAME_PLACE)]


def retarget_properties(
    stored: Sequence[str],
    resolved: Sequence[str],
    names: Sequence[str],
    properties: Sequence[ObjectProperties],
    world: Callable[[], NDArray[np.float64]],
) -> list[ObjectProperties]:
    """The behaviour of all objects, that of copies pointing to what was copied with them.

    A copied action has a uid of its own; its entities, the members of a Parallel
    group, the leaves of a copied lesson and the targets of copied relations are the
    copies made together with the object, or the originals where there are none.

    Parameters
    ----------
    stored, resolved, names
        As for :func:`~.identity.resolve_uids`, and its result.
    properties
        Each object's custom properties as found.
    world
        World matrices float64 (N, 4, 4); only called if there are copies with behaviour.
    """
    groups = copies(stored, resolved, names)
    result = list(properties)
    if not groups:
        return result
    row_of = {uid: row for row, uid in enumerate(resolved)}
    original = {uid: row_of[uid] for uid in groups if uid in row_of}
    found = Copies(
        stored, resolved, {uid: [row_of[each] for each in group] for uid, group in groups.items()}, original, world
    )
    owner = {action.uid: row for row in reversed(range(len(result))) for action in properties[row].actions}
    owner |= {action.uid: row for row in original.values() for action in properties[row].actions}
    for row, (old, new) in enumerate(zip(stored, resolved, strict=True)):
        if old and old != new:
            result[row] = _retargeted(properties[row], row, found, owner)
    return result


def _retargeted(record: ObjectProperties, row: int, found: Copies, owner: dict[str, int]) -> ObjectProperties:
    new = found.resolved[row]

    def action_uid(uid: str) -> str:
        """The uid of a copy's action."""
        holder = owner.get(uid)
        if holder is None:
            return uid
        moved = found.companion(row, found.stored[holder])
        return derived_uid(uid, moved) if moved != found.stored[holder] else uid

    def moved(action: ActionData) -> ActionData:
        """The action with what was copied in place of the originals."""
        entities = {uid: found.companion(row, uid) for uid in (*action.targets, *action.tools, action.frame) if uid}
        return retarget_copy(action, new, entities | {uid: action_uid(uid) for uid in action.members})

    return replace(
        record,
        actions=tuple(map(moved, record.actions)),
        relations=tuple(Relation(each.kind, found.companion(row, each.target)) for each in record.relations),
        lsa=None if record.lsa is None else copied_lesson(record.lsa, new, action_uid),
    )


def copied_lesson(node: LessonNode, owner: str, action_uid: Callable[[str], str]) -> LessonNode:
    """A lesson of a copied object: nodes with uids of their own, leaves that perform the copied actions."""
    return replace(
        node,
        uid=derived_uid(node.uid, owner),
        action=action_uid(node.action) if node.action else "",
        requires=tuple(derived_uid(uid, owner) for uid in node.requires),
        children=tuple(copied_lesson(child, owner, action_uid) for child in node.children),
    )
