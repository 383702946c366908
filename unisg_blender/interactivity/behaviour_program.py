"""A small language for behaviour graphs: expressions, steps, and what starts them.

Expressions are values of the types of KHR_interactivity, made of its operations; steps run one after another and set
variables, send events, branch and repeat. A block may be used in several places and is written once, as a subroutine.
:mod:`.graph_writer` turns a program into the standard's JSON.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

Literal: TypeAlias = "bool | int | float"


@dataclass(frozen=True, eq=False)
class Expression:
    """A value: an operation of the standard with named inputs.

    Attributes
    ----------
    kind
        Its type, such as "bool", "int", "float", "float3", "float4x4".
    op
        The operation, "" for a constant.
    inputs
        Values by the names of the operation's sockets.
    configuration
        Of the operation; a type stands by its name, a pointer by an entity's row ("node") and what is meant of it.
    socket
        Which of the operation's outputs it is.
    constant
        Numbers of a constant.
    """

    kind: str
    op: str = ""
    inputs: Mapping[str, Expression] = field(default_factory=dict)
    configuration: Mapping[str, str | int] = field(default_factory=dict)
    socket: str = "value"
    constant: tuple[Literal, ...] = ()

    def __and__(self, other: Expression) -> Expression:
        return binary("math/and", "bool", self, other)

    def __or__(self, other: Expression) -> Expression:
        return binary("math/or", "bool", self, other)

    def __invert__(self) -> Expression:
        return Expression("bool", "math/not", {"a": self})

    def __add__(self, other: Expression) -> Expression:
        return binary("math/add", self.kind, self, other)

    def __sub__(self, other: Expression) -> Expression:
        return binary("math/sub", self.kind, self, other)

    def __mul__(self, other: Expression) -> Expression:
        return binary("math/mul", self.kind, self, other)

    def __le__(self, other: Expression) -> Expression:
        return binary("math/le", "bool", self, other)

    def __gt__(self, other: Expression) -> Expression:
        return binary("math/gt", "bool", self, other)

    def equals(self, other: Expression) -> Expression:
        """Whether both are the same number."""
        return binary("math/eq", "bool", self, other)


def binary(op: str, kind: str, first: Expression, second: Expression) -> Expression:
    """An operation on two values."""
    return Expression(kind, op, {"a": first, "b": second})


def unary(op: str, value: Expression, kind: str = "") -> Expression:
    """An operation on one value, which keeps its type unless another is given."""
    return Expression(kind or value.kind, op, {"a": value})


def constant(kind: str, *numbers: Literal) -> Expression:
    """A constant; of a matrix the numbers of one column after another."""
    return Expression(kind, constant=numbers)


def whole(number: int) -> Expression:
    """An integer."""
    return constant("int", int(number))


def real(number: float) -> Expression:
    """A floating-point number."""
    return constant("float", float(number))


YES, NO = constant("bool", True), constant("bool", False)


def any_of(values: Iterable[Expression]) -> Expression:
    """Whether one of some conditions holds; false for none."""
    return _joined("math/or", list(values), NO)


def all_of(values: Iterable[Expression]) -> Expression:
    """Whether all of some conditions hold; true for none."""
    return _joined("math/and", list(values), YES)


def _joined(op: str, values: list[Expression], none: Expression) -> Expression:
    values = [value for value in values if value is not none]
    while len(values) > 1:  # by pairs, so that many values are no deeper than need be
        pairs = [binary(op, "bool", *values[at : at + 2]) for at in range(0, len(values) - 1, 2)]
        values = pairs + values[len(values) & ~1 :]
    return values[0] if values else none


@dataclass(frozen=True, eq=False)
class GraphVariable:
    """What the graph remembers, with its value at the start."""

    name: str
    initial: Expression

    @property
    def value(self) -> Expression:
        """What it is when it is asked for."""
        return Expression(self.initial.kind, "variable/get", configuration={"variable": self.name})


@dataclass(frozen=True, eq=False)
class GraphEvent:
    """An event that the graph sends or receives: its id and the types of its values."""

    id: str
    values: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class Put:
    """Set variables, all at once: no value is that of another one that is set."""

    variables: tuple[GraphVariable, ...]
    values: tuple[Expression, ...]


def put(*pairs: tuple[GraphVariable, Expression]) -> Put:
    """Set some variables, at least one, to values."""
    return Put(tuple(variable for variable, _ in pairs), tuple(value for _, value in pairs))


@dataclass(frozen=True, eq=False)
class Send:
    """Send an event."""

    event: GraphEvent
    values: Mapping[str, Expression]


@dataclass(frozen=True, eq=False)
class Branch:
    """Go one way or the other."""

    condition: Expression
    then: StepBlock
    otherwise: StepBlock | None = None


@dataclass(frozen=True, eq=False)
class While:
    """Repeat as long as a condition holds."""

    condition: Expression
    body: StepBlock


@dataclass(frozen=True, eq=False)
class Interpolate:
    """Let a property of a node, by its number in the asset, become a value in some seconds, then go on."""

    configuration: Mapping[str, str | int]
    node: Expression
    value: Expression
    seconds: Expression
    then: StepBlock


@dataclass(eq=False)
class StepBlock:
    """Steps in their order; filled after it was made where blocks use each other."""

    steps: list[Step] = field(default_factory=list)


Step: TypeAlias = "Put | Send | Branch | While | Interpolate | StepBlock"


@dataclass(frozen=True, eq=False)
class Start:
    """An event that starts a block: its operation, with what configures it."""

    op: str
    block: StepBlock
    event: GraphEvent | None = None
    node: int | None = None


@dataclass(frozen=True, eq=False)
class Program:
    """All of a graph: what it remembers, what it sends and receives, and what it does when."""

    variables: tuple[GraphVariable, ...]
    events: tuple[GraphEvent, ...]
    starts: tuple[Start, ...]
    node_of: Callable[[int], int]
    """The node of an entity in the asset, by its row."""


TIME = Expression("float", "event/onTick", socket="timeSinceStart")
"""Seconds since the graph started, in what a tick starts."""


def received(event: GraphEvent, name: str) -> Expression:
    """A value of an event, in what it starts."""
    return Expression(event.values[name], "event/receive", configuration={"event": event.id}, socket=name)
