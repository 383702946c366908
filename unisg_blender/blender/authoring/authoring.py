"""Edit actions and lessons of Blender objects: what the panels' buttons do."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import bpy
import numpy as np

from ...behaviour.lesson.edit import insert, new_node
from ...errors import UniSGError
from ...scene.action_data import ActionData, Thresholds
from ...scene.identity import new_uid
from ...scene.lesson_node import LessonNode
from ..lookup import objects_by_uid, stored_uid
from .identities import ensure_uid, repair_copies
from .stored_behaviour import actions_of, lesson_of, store_actions, store_lesson

SLOTS = ("targets", "tools", "frame")
STARTS = {
    "Insert": Thresholds(distance=0.02, angle=0.26),
    "Remove": Thresholds(distance=0.1),
    "Use": Thresholds(hold=1.0),
    "Tool": Thresholds(distance=0.02, angle=0.26, hits=1),
    "Question": Thresholds(),
    "Parallel": Thresholds(),
}
"""Thresholds that a new action of each type begins with."""


def identity_of(scene: bpy.types.Scene, item: bpy.types.Object) -> str:
    """The uid by which actions refer to an object; written down if it may be and is not yet.

    Copies that still share their original's uid are told apart first.
    """
    repair_copies(scene)
    if stored_uid(item) or item.library is None:
        return ensure_uid(item)
    return next(uid for uid, each in objects_by_uid(scene).items() if each == item)


def add_action(scene: bpy.types.Scene, item: bpy.types.Object, kind: str) -> int:
    """Give an object a new action, the object itself its target; returns the action's place."""
    own = identity_of(scene, item)
    action = ActionData(new_uid(), kind, f"{kind} {item.name}", thresholds=STARTS.get(kind, Thresholds()))
    if kind not in ("Question", "Parallel"):
        action = replace(action, targets=(own,), names={own: item.name})
    if kind == "Question":
        action = replace(action, answers=("Yes", "No"), correct=(0,), name="A question?")
    actions = actions_of(item)
    store_actions(item, (*actions, action))
    return len(actions)


def change_action(item: bpy.types.Object, place: int, edit: Callable[[ActionData], ActionData]) -> None:
    """Change one action of an object by a function."""
    actions = list(actions_of(item))
    if not 0 <= place < len(actions):
        raise UniSGError(f"{item.name!r} has no action number {place + 1}")
    actions[place] = edit(actions[place])
    store_actions(item, actions)


LISTS = ("targets", "tools", "members")
"""What an action names several of."""


def link_objects(
    scene: bpy.types.Scene, item: bpy.types.Object, place: int, slot: str, others: Iterable[bpy.types.Object]
) -> None:
    """Add objects to an action's ``targets`` or ``tools``, or make the first its ``frame``."""
    named = {identity_of(scene, other): other.name for other in others}

    def edit(action: ActionData) -> ActionData:
        """The action with the objects added to its slot."""
        known = {**action.names, **named}
        if slot == "frame":
            return replace(action, frame=next(iter(named), ""), names=known)
        changes: dict[str, Any] = {slot: tuple(dict.fromkeys((*_listed(action, slot), *named)))}
        return replace(action, names=known, **changes)

    change_action(item, place, edit)


def _listed(action: ActionData, slot: str) -> tuple[str, ...]:
    if slot not in LISTS:
        raise UniSGError(f"an action has no {slot[:50]!r}: it has {', '.join(LISTS)} and a frame")
    return getattr(action, slot)


def unlink_object(item: bpy.types.Object, place: int, slot: str, uid: str) -> None:
    """Take an entity out of an action's ``targets``, ``tools`` or ``frame``, or an action out of its ``members``."""

    def edit(action: ActionData) -> ActionData:
        """The action without the object in its slot."""
        if slot == "frame":
            return replace(action, frame="")
        changes: dict[str, Any] = {slot: tuple(each for each in _listed(action, slot) if each != uid)}
        return replace(action, **changes)

    change_action(item, place, edit)


def posed_object(scene: bpy.types.Scene, action: ActionData) -> bpy.types.Object:
    """The object whose pose an action is about: its first target, the first tool of a Tool action.

    Raises
    ------
    UniSGError
        If there is none in the scene.
    """
    uids = action.tools if action.type == "Tool" else action.targets
    objects = objects_by_uid(scene)
    found = next((objects[uid] for uid in uids if uid in objects), None)
    if found is None:
        raise UniSGError("choose a tool first" if action.type == "Tool" else "choose a target first")
    return found


def reference_from_pose(scene: bpy.types.Scene, item: bpy.types.Object, place: int) -> None:
    """Make the present pose of an action's target its reference pose, in the action's frame."""

    def edit(action: ActionData) -> ActionData:
        """The action with the object's pose now, in its frame, as reference."""
        world = np.array(posed_object(scene, action).matrix_world)
        pose = np.linalg.pinv(frame_matrix(scene, action)) @ world
        return replace(action, reference=(*pose[:3].ravel().tolist(), 0.0, 0.0, 0.0, 1.0))

    change_action(item, place, edit)


def frame_matrix(scene: bpy.types.Scene, action: ActionData) -> np.ndarray:
    """World matrix (4, 4) of the frame in which an action's reference pose is given."""
    if not action.frame:
        return np.eye(4)
    found = objects_by_uid(scene).get(action.frame)
    if found is None:
        raise UniSGError(f"the frame {action.names.get(action.frame, action.frame)!r} is not in the scene")
    return np.array(found.matrix_world)


def set_frame(scene: bpy.types.Scene, item: bpy.types.Object, place: int, frame: bpy.types.Object | None) -> None:
    """Give an action another frame; the reference pose stays where it is in the world."""
    uid = identity_of(scene, frame) if frame is not None else ""

    def edit(action: ActionData) -> ActionData:
        """The action in the new frame, its reference where it was in the world."""
        old, names = frame_matrix(scene, action), dict(action.names)
        if frame is not None:
            names[uid] = frame.name
        moved = replace(action, frame=uid, names=names)
        if action.reference_matrix is None:
            return moved
        pose = np.linalg.pinv(frame_matrix(scene, moved)) @ old @ action.reference_matrix
        return replace(moved, reference=(*pose[:3].ravel().tolist(), 0.0, 0.0, 0.0, 1.0))

    change_action(item, place, edit)


def scene_actions(scene: bpy.types.Scene) -> list[tuple[bpy.types.Object, ActionData]]:
    """All actions of a scene that can be read, with the objects that they belong to."""
    found = []
    for item in scene.objects:
        try:
            found += [(item, action) for action in actions_of(item)]
        except UniSGError:
            continue  # the panel of that object says what is wrong
    return found


def lesson_objects(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """The objects that stand for operations, by name."""
    found = []
    for item in scene.objects:
        try:
            if lesson_of(item) is not None:
                found.append(item)
        except UniSGError:
            continue
    return sorted(found, key=lambda item: item.name)


def new_lesson(scene: bpy.types.Scene, name: str) -> bpy.types.Object:
    """An Empty that stands for a new operation with one lesson and one stage."""
    item = bpy.data.objects.new(name, None)
    item.empty_display_size = 0.2
    scene.collection.objects.link(item)
    ensure_uid(item)
    root, lesson, stage = new_node("operation", name), new_node("lesson", name), new_node("stage", "Stage")
    store_lesson(item, insert(insert(root, root.uid, lesson), lesson.uid, stage))
    return item


def change_lesson(item: bpy.types.Object, edit: Callable[[LessonNode], LessonNode]) -> None:
    """Change the operation that an object stands for by a function."""
    root = lesson_of(item)
    if root is None:
        raise UniSGError(f"{item.name!r} stands for no lesson")
    store_lesson(item, edit(root))
