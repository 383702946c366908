"""Runs a behaviour graph of KHR_interactivity: the operations that lessons are made of, as the standard says them.

It is what the graphs are tested with where no other player is; it knows nothing of lessons. Matrices are lists of 16
numbers, one column after another, as in glTF.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from ..errors import UniSGError

Values = list[Any]
"""The numbers of a value; a scalar has one."""

Sent = tuple[str, dict[str, Any]]
"""The id of an event and its values."""

PARTS = re.compile(r"/nodes/\[n\]/(translation|rotation)")
WORLD = re.compile(r"/nodes/(\d+)/globalMatrix")
MOST_ROUNDS = 100_000
"""Rounds of one loop after which it is taken not to end."""


class Going(NamedTuple):
    """A property of a node that is on its way: when it arrives, by which step, what it becomes."""

    end: float
    step: int
    node: int
    name: str
    value: Values


class GraphPlayer:
    """One graph being played.

    ``world`` gives the global matrix of a node, ``place`` its translation and rotation by name, which the graph may
    change; :meth:`send`, :meth:`select` and :meth:`tick` return the events that the graph sent.
    """

    def __init__(
        self, graph: Mapping[str, Any], world: Callable[[int], Sequence[float]],
        place: Callable[[int], dict[str, Values]] | None = None,
    ) -> None:  # fmt: skip
        self._graph, self._world, self._place = graph, world, place
        self._going: list[Going] = []
        self._time = 0.0
        self._nodes: list[dict[str, Any]] = graph["nodes"]
        self._ops = [graph["declarations"][node["declaration"]]["op"] for node in self._nodes]
        self._variables = [list(each["value"]) for each in graph.get("variables", ())]
        self._outputs: dict[tuple[int, str], Values] = {}
        self._values: dict[tuple[int, str], Values] = {}
        self._sent: list[Sent] = []

    def tick(self, seconds: float) -> list[Sent]:
        """A frame, so many seconds after the start."""
        self._time = seconds
        arrived = [each for each in self._going if each.end <= seconds]
        self._going = [each for each in self._going if each.end > seconds]
        self._sent, self._values = [], {}
        for each in arrived:
            self._placed(each.node)[each.name] = each.value
            self._follow(self._nodes[each.step], "done")
        return self._sent + self._happen("event/onTick", {}, {"timeSinceStart": [seconds]})

    def send(self, event: str, **values: Any) -> list[Sent]:
        """An event from outside."""
        number = [each["id"] for each in self._graph["events"]].index(event)
        return self._happen("event/receive", {"event": number}, {name: [value] for name, value in values.items()})

    def select(self, node: int) -> list[Sent]:
        """Somebody selects a node."""
        return self._happen("event/onSelect", {"nodeIndex": node}, {})

    def _placed(self, node: int) -> dict[str, Values]:
        if self._place is None:
            raise UniSGError("the graph moves things, and there is nothing here that says where they stand")
        return self._place(node)

    def _go(self, place: int, node: Mapping[str, Any]) -> None:
        """Begin to move something: it arrives at once, when its time is over."""
        found = PARTS.fullmatch(_setting(node, "pointer"))
        if found is None:
            raise UniSGError(f"the graph changes {_setting(node, 'pointer')}, which is not known here")
        number, seconds = int(self._input(node, "n")[0]), float(self._input(node, "duration")[0])
        self._going = [each for each in self._going if (each.node, each.name) != (number, found[1])]
        self._going.append(Going(self._time + seconds, place, number, found[1], self._input(node, "value")))
        self._follow(node, "out")

    def _happen(self, op: str, settings: Mapping[str, Any], outputs: Mapping[str, Values]) -> list[Sent]:
        self._sent, self._values = [], {}
        for place, node in enumerate(self._nodes):
            if self._ops[place] == op and all(_setting(node, name) == value for name, value in settings.items()):
                self._outputs |= {(place, name): value for name, value in outputs.items()}
                self._follow(node, "out")
        return self._sent

    def _follow(self, node: Mapping[str, Any], flow: str) -> None:
        target = node.get("flows", {}).get(flow)
        if target is not None:
            self._run(target["node"])

    def _run(self, place: int) -> None:
        node, op = self._nodes[place], self._ops[place]
        match op:
            case "flow/sequence":
                for flow in sorted(node.get("flows", {}), key=lambda name: name.encode("utf-16-be")):
                    self._follow(node, flow)
            case "flow/branch":
                self._follow(node, "true" if self._input(node, "condition")[0] else "false")
            case "flow/while":
                self._repeat(node)
            case "variable/set":
                found = {int(name): self._input(node, name) for name in node["values"]}
                for variable, value in found.items():
                    self._variables[variable] = value
                self._values = {}
                self._follow(node, "out")
            case "event/send":
                event = self._graph["events"][_setting(node, "event")]
                values = {name: self._input(node, name) for name in node.get("values", {})}
                self._sent.append((event["id"], {name: found[0] for name, found in values.items()}))
                self._follow(node, "out")
            case "pointer/interpolate":
                self._go(place, node)
            case _:
                raise UniSGError(f"the graph has the operation {op}, which is not known here")

    def _repeat(self, node: Mapping[str, Any]) -> None:
        for _ in range(MOST_ROUNDS):
            if not self._input(node, "condition")[0]:
                self._follow(node, "completed")
                return
            self._follow(node, "loopBody")
        raise UniSGError(f"a loop of the graph does not end within {MOST_ROUNDS} rounds")

    def _input(self, node: Mapping[str, Any], name: str) -> Values:
        source = node["values"][name]
        if "node" not in source:
            return list(source["value"])
        return self._output(source["node"], source.get("socket", "value"))

    def _output(self, place: int, socket: str) -> Values:
        if (place, socket) in self._outputs:
            return self._outputs[place, socket]
        if (place, socket) not in self._values:
            self._values[place, socket] = self._evaluated(place)
        return self._values[place, socket]

    def _evaluated(self, place: int) -> Values:
        node, op = self._nodes[place], self._ops[place]
        if op == "variable/get":
            return self._variables[_setting(node, "variable")]
        if op == "pointer/get":
            part = PARTS.fullmatch(_setting(node, "pointer"))
            if part is not None:
                return list(self._placed(int(self._input(node, "n")[0]))[part[1]])
            found = WORLD.fullmatch(_setting(node, "pointer"))
            if found is None:
                raise UniSGError(f"the graph asks for {_setting(node, 'pointer')}, which is not known here")
            return list(self._world(int(found[1])))
        inputs = [self._input(node, name) for name in sorted(node.get("values", {}))]
        if op not in OPERATIONS:
            raise UniSGError(f"the graph has the operation {op}, which is not known here")
        return OPERATIONS[op](*inputs)


def _setting(node: Mapping[str, Any], name: str) -> Any:
    return node["configuration"][name]["value"][0]


def _each(function: Callable[..., Any]) -> Callable[..., Values]:
    """An operation that works number by number."""
    return lambda *inputs: [function(*numbers) for numbers in zip(*inputs, strict=True)]


def _dot(a: Values, b: Values) -> Values:
    return [math.fsum(map(operator.mul, a, b))]


def _length(a: Values) -> Values:
    return [math.hypot(*a)]


def _normalized(a: Values) -> Values:
    size = math.hypot(*a)
    return [x / size for x in a] if size > 0 and math.isfinite(size) else [0.0 for _ in a]


def _cross(a: Values, b: Values) -> Values:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _transform(a: Values, b: Values) -> Values:
    size = len(a)
    return [sum(a[column] * b[column * size + row] for column in range(size)) for row in range(size)]


OPERATIONS: Mapping[str, Callable[..., Values]] = {
    "math/abs": _each(abs),
    "math/neg": _each(operator.neg),
    "math/add": _each(operator.add),
    "math/sub": _each(operator.sub),
    "math/mul": _each(operator.mul),
    "math/max": _each(max),
    "math/min": _each(min),
    "math/sqrt": _each(lambda x: math.sqrt(x) if x >= 0 else math.nan),
    "math/le": _each(operator.le),
    "math/lt": _each(operator.lt),
    "math/gt": _each(operator.gt),
    "math/ge": _each(operator.ge),
    "math/not": _each(operator.not_),
    "math/and": _each(lambda a, b: a and b if isinstance(a, bool) else a & b),
    "math/or": _each(lambda a, b: a or b if isinstance(a, bool) else a | b),
    "math/eq": lambda a, b: [a == b],
    "math/dot": _dot,
    "math/length": _length,
    "math/normalize": _normalized,
    "math/cross": _cross,
    "math/transform": _transform,
    "math/combine3": lambda a, b, c: [*a, *b, *c],
    "math/combine4": lambda a, b, c, d: [*a, *b, *c, *d],
}
"""What operations without a state give, by the numbers of their inputs in the order of the sockets' names."""
