"""A program as the JSON of a KHR_interactivity graph.

Events come first, then all values, each once and after those that it is made of, then the flow: every step before what
it activates. Source: KHR_interactivity, sections "JSON Syntax" and "Socket Order".
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from .behaviour_program import (
    Branch,
    Expression,
    Interpolate,
    Literal,
    Program,
    Put,
    Send,
    Start,
    Step,
    StepBlock,
    While,
    constant,
)

EXTENSION = "KHR_interactivity"
SELECTABILITY = "KHR_node_selectability"
SELECTED = {
    "selectedNode": "ref", "selectionRayOrigin": "float3", "selectionPoint": "float3", "controllerIndex": "int",
    "event": "ref",
}  # fmt: skip
"""What ``event/onSelect`` gives."""

EASE = constant("float2", 0.4, 0.0), constant("float2", 0.6, 1.0)
"""Control points of a motion that begins and ends gently."""


def graph_json(program: Program) -> dict[str, Any]:
    """The graph: ``types``, ``variables``, ``events``, ``declarations`` and ``nodes``."""
    return _Writer(program).graph()


class _Writer:
    def __init__(self, program: Program) -> None:
        self._program = program
        self._types: dict[str, int] = {}
        self._declarations: dict[str, int] = {}
        self._variables = {each.name: place for place, each in enumerate(program.variables)}
        self._events = {each.id: place for place, each in enumerate(program.events)}
        self._nodes: list[dict[str, Any]] = []
        self._known: dict[Hashable, int] = {}
        self._places: dict[int, int] = {}
        self._kept: list[Expression] = []

    def graph(self) -> dict[str, Any]:
        """Events, values, flow, in this order."""
        program = self._program
        starts = [self._start(start) for start in program.starts]
        steps = _ordered([start.block for start in program.starts])
        records = [(step, self._step(step)) for step in steps]
        place = {id(step): len(self._nodes) + number for number, step in enumerate(steps)}
        for step, record in records:
            if flows := {name: {"node": place[id(_only(block))]} for name, block in _targets(step)}:
                record["flows"] = flows
            self._nodes.append(record)
        for start, node in zip(program.starts, starts, strict=True):
            self._nodes[node]["flows"] = {"out": {"node": place[id(_only(start.block))]}}
        found = {
            "variables": [self._typed(each.initial) for each in program.variables],
            "events": [
                {"id": each.id, "values": {name: {"type": self._type(kind)} for name, kind in each.values.items()}}
                for each in program.events
            ],
            "declarations": [self._declaration(op) for op in self._declarations],
            "nodes": self._nodes,
        }
        return {"types": [{"signature": kind} for kind in self._types]} | {k: v for k, v in found.items() if v}

    def _start(self, start: Start) -> int:
        record = self._node(start.op)
        if start.event is not None:
            record["configuration"] = {"event": {"value": [self._events[start.event.id]]}}
        if start.node is not None:
            record["configuration"] = {"nodeIndex": {"value": [self._program.node_of(start.node)]}}
        self._nodes.append(record)
        self._known[start.op, start.event.id if start.event else "", ()] = len(self._nodes) - 1
        return len(self._nodes) - 1

    def _step(self, step: Step) -> dict[str, Any]:
        match step:
            case Put():
                places = [self._variables[variable.name] for variable in step.variables]
                node = self._node("variable/set", {"variables": {"value": places}})
                sources = [self._source(value) for value in step.values]
                return node | {"values": dict(zip(map(str, places), sources, strict=True))}
            case Send():
                node = self._node("event/send", {"event": {"value": [self._events[step.event.id]]}})
                return node | {"values": {name: self._source(value) for name, value in step.values.items()}}
            case Branch():
                return self._node("flow/branch") | {"values": {"condition": self._source(step.condition)}}
            case While():
                return self._node("flow/while") | {"values": {"condition": self._source(step.condition)}}
            case Interpolate():
                values = {"n": step.node, "value": step.value, "duration": step.seconds, "p1": EASE[0], "p2": EASE[1]}
                found = {name: self._setting(name, each) for name, each in step.configuration.items()}
                node = self._node("pointer/interpolate", found)
                return node | {"values": {name: self._source(each) for name, each in values.items()}}
            case StepBlock():
                return self._node("flow/sequence")

    def _node(self, op: str, configuration: dict[str, Any] | None = None) -> dict[str, Any]:
        record: dict[str, Any] = {"declaration": self._declarations.setdefault(op, len(self._declarations))}
        return record | ({"configuration": configuration} if configuration else {})

    def _declaration(self, op: str) -> dict[str, Any]:
        if op != "event/onSelect":
            return {"op": op}
        sockets = {name: {"type": self._type(kind)} for name, kind in SELECTED.items()}
        return {"op": op, "extension": SELECTABILITY, "outputValueSockets": sockets}

    def _type(self, kind: str) -> int:
        return self._types.setdefault(kind, len(self._types))

    def _typed(self, value: Expression) -> dict[str, Any]:
        return {"type": self._type(value.kind), "value": [_short(number) for number in value.constant]}

    def _source(self, value: Expression) -> dict[str, Any]:
        """How a socket says where its value comes from."""
        if not value.op:
            return self._typed(value)
        source: dict[str, Any] = {"node": self._place(value)}
        return source if value.socket == "value" else source | {"socket": value.socket}

    def _place(self, value: Expression) -> int:
        """The node of a value that is no constant; one that is the same as another is not written again."""
        if id(value) not in self._places:
            if value.op.startswith("event/"):
                key: Hashable = (value.op, str(value.configuration.get("event", "")), ())
                self._places[id(value)] = self._known[key]
            else:
                self._places[id(value)] = self._written(value)
            self._kept.append(value)  # as long as it is there, its id is its own
        return self._places[id(value)]

    def _written(self, value: Expression) -> int:
        sources = {name: self._source(each) for name, each in value.inputs.items()}
        key = (value.op, str(sorted(value.configuration.items())), str(sorted(sources.items())))
        if key not in self._known:
            record = self._node(value.op, self._settings(value))
            self._nodes.append(record | ({"values": sources} if sources else {}))
            self._known[key] = len(self._nodes) - 1
        return self._known[key]

    def _settings(self, value: Expression) -> dict[str, Any]:
        """What configures an operation; a pointer is put together."""
        given = dict(value.configuration)
        if "node" in given:
            given["pointer"] = f"/nodes/{self._program.node_of(int(given.pop('node')))}/{given['pointer']}"
        return {name: self._setting(name, each) for name, each in given.items()}

    def _setting(self, name: str, value: str | int) -> dict[str, Any]:
        if name == "variable":
            return {"value": [self._variables[str(value)]]}
        return {"value": [self._type(str(value)) if name == "type" else value]}


def _short(number: Literal) -> Literal:
    """A number in twelve digits, more than tolerances ask for; a whole one has no fraction."""
    if not isinstance(number, float):
        return number
    short = float(f"{number:.12g}")
    return int(short) if short.is_integer() else short


def _only(step: Step) -> Step:
    """A block of one step is that step."""
    while isinstance(step, StepBlock) and len(step.steps) == 1:
        step = step.steps[0]
    return step


def _targets(step: Step) -> list[tuple[str, Step]]:
    """What a step activates, by the names of its flows."""
    match step:
        case Branch():
            other = [] if step.otherwise is None else [("false", step.otherwise)]
            return [(name, block) for name, block in [("true", step.then), *other] if _does_something(block)]
        case While():
            return [("loopBody", step.body)]
        case Interpolate():
            return [("done", step.then)] if _does_something(step.then) else []
        case StepBlock():
            steps = [each for each in step.steps if _does_something(each)]
            width = len(str(len(steps) - 1))  # flows are sorted as texts
            return [(f"{number:0{width}d}", each) for number, each in enumerate(steps)]
    return []


def _does_something(step: Step) -> bool:
    return not isinstance(step, StepBlock) or bool(step.steps)


def _ordered(blocks: list[StepBlock]) -> list[Step]:
    """All steps, each once and before those that it activates."""
    finished: list[Step] = []
    entered: set[int] = set()
    pending: list[tuple[Step, bool]] = [(_only(block), False) for block in blocks]
    while pending:
        step, ready = pending.pop()
        if ready:
            finished.append(step)
        elif id(step) not in entered:
            entered.add(id(step))
            pending.append((step, True))
            pending += [(_only(target), False) for _, target in _targets(step)]
    return finished[::-1]
