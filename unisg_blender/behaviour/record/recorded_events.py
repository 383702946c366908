"""Events of a recording: what a lesson made of it, and what the user did besides moving objects."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import TypeVar

from ...scene.components import ANIMATION, EVENTS, RECORDING
from ...scene.graph import SceneGraph
from ...scene.recording_tables import RecordedEvent, event_table
from ..fulfilment.snapshot import Moment
from ..playing.player import Event, Lesson
from .motion_tracks import Input, Motion, Track

WORDS = {
    "opened": "started",
    "done": "performed",
    "skipped": "skipped",
    "out_of_order": "early",
    "wrong_answer": "failed",
}
"""What the events of a lesson are called in a recording."""

PRESSED, RELEASED, FORCE, ANSWERED = "pressed", "released", "force:", "answered:"


def with_events(graph: SceneGraph, events: Iterable[Event], inputs: Iterable[Input]) -> SceneGraph:
    """The scenegraph with the component ``events``: of the actions of a lesson, and the user's inputs."""
    owner = {action.uid: row for row, action in graph.entries("actions", "data")}
    found: list[tuple[int, RecordedEvent]] = []
    for each in inputs:  # before what they bring about in the same moment
        row = graph.row_of_uid.get(each.uid, owner.get(each.uid))
        if row is not None:
            found += [(row, entry) for entry in _entries(each)]
    found += [
        (owner[event.action], (event.time, WORDS[event.kind], event.action))
        for event in events
        if event.action in owner and event.kind in WORDS
    ]
    return graph.with_component(EVENTS, event_table(sorted(found, key=lambda pair: pair[1][0])))


Timed = TypeVar("Timed", Event, Input)


def later(entries: Iterable[Timed], seconds: float) -> list[Timed]:
    """Events or inputs so much later; what would be before 0 is at 0."""
    return [replace(each, time=max(0.0, each.time + seconds)) for each in entries]


def new_inputs(lesson: Lesson, before: Moment | None, now: Moment) -> list[Input]:
    """What the user did with the tools of a lesson, and answered, since the moment before."""
    inputs = [Input(now.time, uid, answer=chosen) for uid, chosen in now.answers.items()]
    row_of = lesson.graph.row_of_uid
    for uid in dict.fromkeys(uid for action in lesson.checks.actions for uid in action.tools if uid in row_of):
        row = row_of[uid]
        trigger, force = bool(now.trigger[row]), float(now.force[row])
        old = (False, 0.0) if before is None else (bool(before.trigger[row]), float(before.force[row]))
        if (trigger, force) != old:
            inputs.append(
                Input(now.time, uid, trigger if trigger != old[0] else None, force if force != old[1] else None)
            )
    return inputs


def _entries(each: Input) -> Iterator[RecordedEvent]:
    if each.trigger is not None:
        yield each.time, PRESSED if each.trigger else RELEASED, ""
    if each.force is not None:
        yield each.time, f"{FORCE}{each.force:g}", ""
    if each.answer is not None:
        yield each.time, ANSWERED + ",".join(map(str, each.answer)), each.uid


def recorded_motion(graph: SceneGraph, rate: float = 30.0) -> Motion:
    """The motion that a scenegraph holds: its recording, with what the user did; where there is none its animation."""
    tracks: dict[int, Track] = {}
    for name in (ANIMATION, RECORDING):
        for row, times, matrices in graph.entries(name, "times", "matrices"):
            tracks[row] = Track(graph.uid[row], times, matrices)
    return Motion(tuple(tracks.values()), recorded_inputs(graph), rate)


def recorded_inputs(graph: SceneGraph) -> tuple[Input, ...]:
    """What the user did while a recording was made, besides moving objects."""
    entries = graph.entries(EVENTS, "time", "event", "action")
    inputs = [_input(graph.uid[row], float(when), word, action) for row, when, word, action in entries]
    return tuple(sorted((each for each in inputs if each is not None), key=lambda each: each.time))


def _input(uid: str, when: float, word: str, action: str) -> Input | None:
    if word in (PRESSED, RELEASED):
        return Input(when, uid, trigger=word == PRESSED)
    try:
        if word.startswith(FORCE):
            return Input(when, uid, force=float(word.removeprefix(FORCE)))
        if word.startswith(ANSWERED):
            return Input(when, action, answer=tuple(int(at) for at in word.removeprefix(ANSWERED).split(",") if at))
    except ValueError:
        return None
    return None
