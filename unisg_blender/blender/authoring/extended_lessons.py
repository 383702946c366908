"""Write what new behaviour adds to objects that stand in the scene already: their lessons, and uids to refer to."""

from __future__ import annotations

from collections.abc import Collection

import bpy

from ...errors import UniSGError
from ...scene.graph import SceneGraph
from ...scene.properties import LSA, UID
from ..lookup import objects_by_uid, stored_uid
from .stored_behaviour import lesson_of, store_lesson, why_fixed


def extend_lessons(graph: SceneGraph, rows: Collection[int], scene: bpy.types.Scene) -> None:
    """Bring the lessons of the scene's objects to the state of the scenegraph, whose new ``rows`` are not written yet.

    Objects that actions of the new rows refer to have their uid written down, so
    that renaming them does no harm. Nothing else of the scene changes.

    Raises
    ------
    UniSGError
        If a lesson belongs to an object that may not be changed; nothing is written then.
    """
    standing, new = objects_by_uid(scene), {int(row) for row in rows}
    changed = []
    for row, tree in graph.entries("lsa", "data"):
        item = standing.get(graph.uid[row])
        if row not in new and item is not None and lesson_of(item) != tree:
            if reason := why_fixed(item, LSA):
                raise UniSGError(f"{reason}; or generate without behaviour")
            changed.append((item, tree))
    for item, tree in changed:
        store_lesson(item, tree)
    for uid in _named(graph, new):
        item = standing.get(uid)
        if item is not None and not stored_uid(item) and item.library is None:
            item[UID] = uid


def _named(graph: SceneGraph, rows: Collection[int]) -> set[str]:
    """Uids that actions of some rows refer to."""
    actions = [action for row, action in graph.entries("actions", "data") if row in rows]
    return {uid for action in actions for uid in (*action.targets, *action.tools, action.frame) if uid}
