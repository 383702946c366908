"""A lesson played in an open Blender scene."""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from ...behaviour import Event, Input, Lesson, Moment, PlayState, begin, moment, play, prepare
from ...behaviour.lesson.action_places import operations
from ...behaviour.lesson.lesson_progress import OPEN, STATUSES
from ...behaviour.record.recorded_events import new_inputs
from ...scene.action_data import ActionData
from ...scene.hierarchy import world_matrices
from ..authoring.stored_behaviour import FORCE, TRIGGER, world_of
from ..lookup import objects_by_uid
from ..read.scene_reader import read_scene

MESSAGES = ("out_of_order", "wrong_answer", "done")


@dataclass
class Session:
    """A lesson that is being played; knows objects by name and uid, never by themselves.

    ``pressed`` are the uids of tools whose trigger is held, ``force`` in newtons goes
    with them, ``chosen`` the answers ticked so far by uid of the Question. ``inputs`` is
    what the user did besides moving objects, ``started`` the clock (``time.monotonic``)
    at the lesson's time 0.
    """

    scene: str
    lesson: Lesson
    state: PlayState
    world: NDArray[np.float64]
    events: list[Event] = field(default_factory=list)
    pressed: set[str] = field(default_factory=set)
    force: float = 10.0
    chosen: dict[str, tuple[int, ...]] = field(default_factory=dict)
    answers: dict[str, tuple[int, ...]] = field(default_factory=dict)
    time: float = 0.0
    started: float = 0.0
    inputs: list[Input] = field(default_factory=list)
    _before: Moment | None = None

    def step(self, time: float) -> tuple[Event, ...]:
        """Look at the scene at a time in seconds and play on; what happened comes back."""
        scene = bpy.data.scenes[self.scene]
        objects = objects_by_uid(scene)
        self.world = world_of(self.lesson.graph, scene, objects, self.world)
        held = {uid for uid, item in objects.items() if item.get(TRIGGER)} | self.pressed
        force = {uid: float(item[FORCE]) for uid, item in objects.items() if FORCE in item}
        force |= {uid: self.force for uid in self.lesson.graph.uid if uid not in force}
        now = moment(self.lesson.graph, time, self.world, held, force, self.answers)
        self.inputs += new_inputs(self.lesson, self._before, now)
        self.time, self.answers, self._before = time, {}, now
        self.state, events = play(self.lesson, self.state, now)
        self.events += events
        if any(event.kind == "done" for event in events):  # what is no longer asked for can no longer be released
            self.pressed &= {uid for action, _ in self.open_actions() for uid in action.tools}
        return events

    def face(self) -> tuple[bytes, ...]:
        """What the panels show of it: as long as this stays the same, nothing has to be drawn again."""
        actions = self.state.actions
        return self.state.status.tobytes(), actions.met.tobytes(), actions.done.tobytes()

    def answer(self, uid: str) -> None:
        """Give the answers ticked to a Question."""
        self.answers[uid] = self.chosen.pop(uid, ())

    def status(self, uid: str) -> str:
        """How far a node is: "waiting", "open", "done" or "skipped"."""
        for place, node in enumerate(self.lesson.outline.nodes):
            if node.uid == uid:
                return STATUSES[self.state.status[place]]
        return STATUSES[0]

    def open_actions(self) -> list[tuple[ActionData, bool]]:
        """The actions that may be performed now, members of groups too, and whether their condition holds."""
        state, found = self.state.actions, []
        waiting = [int(self.lesson.task[place]) for place in np.flatnonzero(self.state.status == OPEN)]
        groups = {group.index: group.members for group in self.lesson.checks.groups}
        pending = [task for task in waiting if task >= 0][::-1]
        while pending:
            task = pending.pop()
            pending += [int(member) for member in groups.get(task, ())][::-1]
            if not state.done[task]:
                found.append((self.lesson.checks.actions[task], bool(state.met[task])))
        return found

    def message(self) -> Event | None:
        """The last object that a learner should hear."""
        return next((event for event in reversed(self.events) if event.kind in MESSAGES), None)


def open_session(scene: bpy.types.Scene, operation: str = "") -> Session:
    """Begin to play a lesson of a scene, chosen by name or uid; the only one when none is given.

    Raises
    ------
    UniSGError
        If there is none, or it has errors.
    """
    graph = read_scene(scene, details=False)
    chosen = next((each for each in operations(graph) if operation and operation in (each.name, each.uid)), None)
    lesson = prepare(graph, chosen)
    return Session(scene.name, lesson, begin(lesson), world_matrices(graph))
