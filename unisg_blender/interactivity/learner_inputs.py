"""What a learner does besides moving things, as events that the graph receives and variables that keep it.

``unisg:trigger`` {entity, pressed} and ``unisg:force`` {entity, newtons} hold until the next one of that entity (its
node); ``unisg:answer`` {task, chosen} (bit k: answer k) and ``unisg:confirm`` {task} count in the next tick.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from ..behaviour.playing.player import Lesson
from ..scene.action_data import TYPES
from .attention import Attention
from .behaviour_program import (
    NO,
    YES,
    Branch,
    Expression,
    GraphEvent,
    GraphVariable,
    Put,
    Start,
    Step,
    StepBlock,
    put,
    real,
    received,
    whole,
)

TRIGGER = GraphEvent("unisg:trigger", {"entity": "int", "pressed": "bool"})
FORCE = GraphEvent("unisg:force", {"entity": "int", "newtons": "float"})
ANSWER = GraphEvent("unisg:answer", {"task": "int", "chosen": "int"})
CONFIRM = GraphEvent("unisg:confirm", {"task": "int"})


class LearnerInputs:
    """Inputs of those entities and actions that a lesson asks for."""

    def __init__(self, lesson: Lesson, node_of: Callable[[int], int]) -> None:
        self._actions, self._node_of = lesson.checks.actions, node_of
        self.asked = GraphVariable("asked", NO)
        self._pressed: dict[int, GraphVariable] = {}
        self._force: dict[int, GraphVariable] = {}
        self._chosen: dict[str, GraphVariable] = {}
        self._confirmed: dict[int, GraphVariable] = {}
        for task, action in enumerate(self._actions):
            if action.type == "Question":
                self._chosen.setdefault(action.uid, GraphVariable(f"chosen {task}", whole(-1)))
            elif action.type not in TYPES:
                self._confirmed[task] = GraphVariable(f"confirmed {task}", NO)

    def pressed(self, entity: int) -> Expression:
        """An entity's trigger is pressed."""
        return self._pressed.setdefault(entity, GraphVariable(f"pressed {entity}", NO)).value

    def force(self, entity: int) -> Expression:
        """The newtons with which an entity is used."""
        return self._force.setdefault(entity, GraphVariable(f"force {entity}", real(0))).value

    def answered(self, uid: str) -> Expression:
        """A Question has been answered since the last tick."""
        return self._chosen[uid].value > whole(-1)

    def chosen(self, uid: str) -> Expression:
        """The answers that were given, as bits; -1 for none."""
        return self._chosen[uid].value

    def confirmed(self, task: int) -> Expression:
        """Somebody said since the last tick that an action of an own type was done."""
        return self._confirmed[task].value

    @property
    def variables(self) -> tuple[GraphVariable, ...]:
        """What is remembered; ``asked`` is whether there is something of the kind that counts in one tick only."""
        kept = (self._pressed, self._force, self._chosen, self._confirmed)
        return (self.asked, *(variable for each in kept for variable in each.values()))

    @property
    def events(self) -> tuple[GraphEvent, ...]:
        """What is listened to."""
        kept = {TRIGGER: self._pressed, FORCE: self._force, ANSWER: self._chosen, CONFIRM: self._confirmed}
        return tuple(event for event, found in zip(kept, kept.values(), strict=True) if found)

    def starts(self, attention: Attention) -> list[Start]:
        """What happens when an event comes."""
        handlers: dict[str, list[Step]] = {}
        handled = (TRIGGER, "pressed", self._pressed), (FORCE, "newtons", self._force)
        for event, value, kept in handled:
            for entity, variable in kept.items():
                pairs = [(variable, received(event, value)), *attention.waking(attention.about(entity))]
                handlers.setdefault(event.id, []).append(_when(event, "entity", self._node_of(entity), pairs))
        for task, action in enumerate(self._actions):
            if action.type == "Question":
                pairs = [(self._chosen[action.uid], received(ANSWER, "chosen")), *self._told(attention, [task])]
                handlers.setdefault(ANSWER.id, []).append(_when(ANSWER, "task", task, pairs))
        for task, variable in self._confirmed.items():
            pairs = [(variable, YES), *self._told(attention, [task])]
            handlers.setdefault(CONFIRM.id, []).append(_when(CONFIRM, "task", task, pairs))
        return [Start("event/receive", StepBlock(handlers[event.id]), event=event) for event in self.events]

    def confirming(self, task: int, attention: Attention) -> Put:
        """Somebody says that an action of an own type was done."""
        return put((self._confirmed[task], YES), *self._told(attention, [task]))

    def handling(
        self, entity: int, force: float | None, attention: Attention
    ) -> list[tuple[GraphVariable, Expression]]:
        """What presses the trigger of an entity, as far as that is asked for; nothing without a force."""
        pairs = [(kept[entity], value) for kept, value in ((self._pressed, YES), (self._force, real(force or 0)))
                 if force is not None and entity in kept]  # fmt: skip
        return [*pairs, *attention.waking(attention.about(entity))] if pairs else []

    def releasing(self, attention: Attention) -> list[tuple[GraphVariable, Expression]]:
        """What releases all triggers."""
        entities = sorted({*self._pressed, *self._force})
        about = {task for entity in entities for task in attention.about(entity)}
        pairs = [(variable, NO) for variable in self._pressed.values()]
        pairs += [(variable, real(0)) for variable in self._force.values()]
        return [*pairs, *attention.waking(about)]

    def _told(self, attention: Attention, tasks: Iterable[int]) -> list[tuple[GraphVariable, Expression]]:
        return [(self.asked, YES), *attention.waking(tasks)]

    def forget(self, attention: Attention) -> StepBlock:
        """After a tick, what was for that tick only."""
        pairs = [(variable, whole(-1)) for variable in self._chosen.values()]
        pairs += [(variable, NO) for variable in self._confirmed.values()]
        questions = [task for task, action in enumerate(self._actions) if action.type == "Question"]
        return StepBlock([put((self.asked, NO), *pairs, *attention.waking([*questions, *self._confirmed]))])


def _when(event: GraphEvent, key: str, number: int, pairs: list[tuple[GraphVariable, Expression]]) -> Branch:
    """Put what an event says that is about this entity or task."""
    return Branch(received(event, key).equals(whole(number)), StepBlock([put(*pairs)]))
