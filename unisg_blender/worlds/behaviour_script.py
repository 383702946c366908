"""Write the behaviour of a world: actions on its objects, gathered in stages and lessons."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..geometry.arrays import Floats
from ..scene.action_data import ActionData, Thresholds
from ..scene.identity import derived_uid
from ..scene.lesson_node import LessonNode
from .layout import Layout, Placed

Thing = Placed | None
"""What an action is about; an action on an object that found no place in the room is left out."""


class Script:
    """Collects actions by the uid of the entity that they belong to; every method returns the action's uid or ""."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.actions: dict[str, list[ActionData]] = {}
        self._count = 0

    def insert(
        self, name: str, obj: Thing, frame: Thing, at: Floats, distance: float, degrees: float,
        hold: float | None = None,
    ) -> str:  # fmt: skip
        """Bring an object to the pose ``at`` (4x4) in the frame of another, within metres and degrees."""
        if obj is None or frame is None:
            return ""
        limits = Thresholds(distance=distance, angle=round(float(np.radians(degrees)), 6), hold=hold)
        reference = tuple(np.round(at, 9).reshape(-1).tolist())
        return self._add(
            obj, "Insert", name, targets=(obj.uid,), reference=reference, frame=frame.uid, thresholds=limits
        )

    def remove(self, name: str, obj: Thing, distance: float) -> str:
        """Take an object away from where it lies, so many metres."""
        if obj is None:
            return ""
        return self._add(obj, "Remove", name, targets=(obj.uid,), thresholds=Thresholds(distance=distance))

    def use(
        self, name: str, tool: Thing, target: Thing, hold: float, *, distance: float | None = None,
        trigger: bool = False,
    ) -> str:  # fmt: skip
        """Hold a tool to a target (or within metres of it) for so many seconds."""
        if tool is None or target is None:
            return ""
        limits = Thresholds(distance=distance, hold=hold)
        return self._add(
            target, "Use", name, targets=(target.uid,), tools=(tool.uid,), thresholds=limits, trigger=trigger
        )

    def work(self, name: str, tool: Thing, target: Thing, hits: int, force: float | None = None) -> str:
        """Work with a tool on a target, so many strokes of so many newtons."""
        if tool is None or target is None:
            return ""
        limits = Thresholds(hits=hits, force=force)
        return self._add(target, "Tool", name, targets=(target.uid,), tools=(tool.uid,), thresholds=limits)

    def ask(self, name: str, about: Thing, answers: Sequence[str], correct: int) -> str:
        """A question with one right answer."""
        if about is None:
            return ""
        return self._add(about, "Question", name, targets=(about.uid,), answers=tuple(answers), correct=(correct,))

    def group(self, name: str, owner: Thing, members: Sequence[str], mode: str = "all") -> str:
        """All or any of some actions, in any order."""
        members = tuple(member for member in members if member)
        if owner is None or not members:
            return ""
        return self._add(owner, "Parallel", name, members=members, mode=mode)

    def stage(
        self, name: str, actions: Sequence[str], *, ordered: bool = True, optional: Sequence[str] = (),
        requires: Sequence[LessonNode] = (),
    ) -> LessonNode:  # fmt: skip
        """A stage of the actions that exist; those among ``optional`` may be left out by the learner."""
        names = {action.uid: action.name for own in self.actions.values() for action in own}
        leaves = tuple(
            LessonNode("action", self._uid("leaf", action), names[action], action=action, optional=action in optional)
            for action in actions
            if action
        )
        return LessonNode(
            "stage", self._uid("stage", name), name, children=leaves, ordered=ordered,
            requires=tuple(node.uid for node in requires),
        )  # fmt: skip

    def lesson(self, name: str, stages: Sequence[LessonNode]) -> LessonNode:
        """A lesson of the stages that have actions."""
        kept = tuple(stage for stage in stages if stage.children)
        return LessonNode("lesson", self._uid("lesson", name), name, children=kept)

    def operation(self, name: str, lessons: Sequence[LessonNode]) -> LessonNode:
        """The whole, for :meth:`Layout.build`."""
        return LessonNode("operation", self._uid("operation", name), name, children=tuple(lessons))

    def _add(self, owner: Placed, kind: str, name: str, **values: object) -> str:
        uid = self._uid("action", str(self._count))
        self._count += 1
        self.actions.setdefault(owner.uid, []).append(ActionData(uid, kind, name, **values))  # type: ignore[arg-type]
        return uid

    def _uid(self, kind: str, name: str) -> str:
        return derived_uid(self.layout.title, f"{kind} {name}")


def choices(rng: np.random.Generator, right: int, spread: int = 2) -> tuple[list[str], int]:
    """Answers to a question for a number: some numbers around the right one, and the place of the right one."""
    low = max(right - int(rng.integers(0, spread + 1)), 0)
    numbers = list(range(low, low + spread + 2))
    return [str(number) for number in numbers], numbers.index(right)


def turned(x: float, y: float, z: float, yaw: float = 0.0, pitch: float = 0.0) -> Floats:
    """A 4x4 pose: turned by ``pitch`` about x (the front goes up by it, negative: down), then by ``yaw`` about z."""
    cos, sin, up, out = np.cos(yaw), np.sin(yaw), np.sin(-pitch), np.cos(pitch)
    about_z = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, out, -up], [0, up, out]])
    matrix = np.eye(4)
    matrix[:3, :3] = about_z @ about_x
    matrix[:3, 3] = x, y, z
    return matrix
