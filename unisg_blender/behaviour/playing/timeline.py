"""A lesson played from begin to end: which action, when, why."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from typing import Any

from ..fulfilment.snapshot import Moment
from ..lesson.lesson_progress import STATUSES
from .player import Event, Lesson, PlayState, begin, play

VERSION = 1


@dataclass(frozen=True, eq=False)
class Timeline:
    """What happened: all events in order, the state at the end, first and last time in seconds."""

    lesson: Lesson
    events: tuple[Event, ...]
    state: PlayState
    start: float
    end: float

    @property
    def finished(self) -> bool:
        """Everything mandatory was done."""
        return self.state.finished

    def performed(self) -> list[Event]:
        """The actions in the order in which they were performed."""
        return [event for event in self.events if event.kind == "done" and event.node == "action"]


def simulate(
    lesson: Lesson, moments: Iterable[Moment], watch: Callable[[Moment, PlayState], None] | None = None
) -> Timeline:
    """Play a lesson through moments; ``watch`` is called after each."""
    state, events, times = begin(lesson), list[Event](), list[float]()
    for now in moments:
        state, new = play(lesson, state, now)
        events += new
        times = [times[0] if times else now.time, now.time]
        if watch is not None:
            watch(now, state)
    return Timeline(lesson, tuple(events), state, times[0] if times else 0.0, times[-1] if times else 0.0)


def timeline_record(timeline: Timeline) -> dict[str, Any]:
    """A timeline as plain data for JSON: the events, and for every node its status and times."""
    plan = timeline.lesson.outline
    first: dict[tuple[str, str], Event] = {}
    for event in timeline.events:
        first.setdefault((event.uid, event.kind), event)
    nodes = []
    for place, node in enumerate(plan.nodes):
        opened, done = first.get((node.uid, "opened")), first.get((node.uid, "done"))
        task = timeline.lesson.task[place]
        action = timeline.lesson.checks.actions[task] if task >= 0 else None
        name = node.name or (action.name or action.type if action is not None else node.uid)
        nodes.append(
            {
                "kind": node.kind,
                "uid": node.uid,
                "name": name,
                "depth": len(plan.above(place)),
                "type": action.type if action is not None else None,
                "optional": not plan.mandatory[place],
                "status": STATUSES[timeline.state.status[place]],
                "opened": opened.time if opened else None,
                "done": done.time if done else None,
                "why": done.why if done else "",
            }
        )
    return {
        "version": VERSION,
        "operation": plan.nodes[0].name or plan.nodes[0].uid,
        "finished": timeline.finished,
        "start": timeline.start,
        "end": timeline.end,
        "nodes": nodes,
        "events": [asdict(event) for event in timeline.events],
    }
