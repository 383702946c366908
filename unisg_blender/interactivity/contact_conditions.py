"""Whether two bodies touch, as a value of a graph: oriented boxes by their separating axes.

All is told in the first box's axes, so that a vector of the graph holds what three axes ask for at a time: the faces
of the first box, and for each axis b of the second one the three products e x b, for which v . (e x b) = e . (b x v).
Boxes keep the size that they have at the start. Apart by no more than a distance along each axis is less than apart by
no more than that distance: at corners the graph is up to sqrt(3) times as generous. The test is in the graph once: what
it is about is put into variables before. Source: Gottschalk et al. 1996, OBBTree.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..behaviour.fulfilment.body_contact import EPSILON
from .behaviour_program import Expression, GraphVariable, Put, all_of, binary, constant, put, real, unary
from .pose_conditions import carried

AXES = np.eye(3)


class BodyBox(NamedTuple):
    """The box of an entity's body: its row, middle (3,) in its own frame, half extents (3,) in metres of the world.

    In glTF's axes.
    """

    row: int
    middle: NDArray[np.float64]
    half: NDArray[np.float64]


def may_touch(first: BodyBox, second: BodyBox, distance: float) -> Expression:
    """Whether the balls around the boxes come within ``distance`` metres."""
    gap = _gap(first, second)
    reach = np.linalg.norm(first.half) + np.linalg.norm(second.half) + distance + EPSILON
    return binary("math/dot", "float", gap, gap) <= real(float(reach) ** 2)


class BoxTest:
    """The test of two boxes, and the variables that it is about.

    :meth:`about` fills them; then ``touching`` is whether no axis parts the boxes by more than the distance.
    """

    def __init__(self) -> None:
        self._gap = _variable("gap", np.zeros(4))
        self._mine = [_variable(f"axis {k}", np.zeros(4)) for k in range(3)]
        self._others = [_variable(f"other axis {k}", np.zeros(4)) for k in range(3)]
        self._half = _variable("half", np.zeros(3))
        self._halves = [_variable(f"other half {k}", np.zeros(3)) for k in range(3)]
        self._swept = GraphVariable("box swept", constant("float3x3", *[0.0] * 9))
        self._distance = _variable("distance", np.zeros(3))
        mine = [axis.value for axis in self._mine]
        self._place = _seen(self._gap.value, mine)
        self._units = [_seen(axis.value, mine) for axis in self._others]
        self._sizes = [_size(unit) for unit in self._units]
        self.touching = all_of(gap <= real(EPSILON) for gap in self._parted())

    @property
    def variables(self) -> tuple[GraphVariable, ...]:
        """What it is about."""
        return (self._gap, *self._mine, *self._others, self._half, *self._halves, self._swept, self._distance)

    def about(self, first: BodyBox, second: BodyBox, distance: float) -> Put:
        """Let it be about two boxes and how near they have to come."""
        x, y, z = first.half.tolist()
        swept = constant("float3x3", 0.0, z, y, z, 0.0, x, y, x, 0.0)  # sum of half extents times |b x e|
        return put(
            (self._gap, _gap(first, second)),
            *zip(self._mine, _axes(first.row), strict=True),
            *zip(self._others, _axes(second.row), strict=True),
            (self._half, _vector(first.half)),
            *((kept, _vector(np.full(3, half))) for kept, half in zip(self._halves, second.half, strict=True)),
            (self._swept, swept),
            (self._distance, _vector(np.full(3, distance))),
        )

    def _parted(self) -> list[Expression]:
        """By how much the axes part the boxes beyond the distance, the largest of each kind."""
        half, distance = self._half.value, self._distance.value
        pairs = list(zip(self._sizes, self._halves, strict=True))
        widest = _size(self._place) - half - distance - _sum([size * kept.value for size, kept in pairs])
        for k in range(3):
            widest = binary("math/max", "float3", widest, self._edges(k))
        faces = [
            _size(_dot(self._place, unit)) - _dot(half, size) - _dot(kept.value + distance, _vector(AXES[0]))
            for unit, (size, kept) in zip(self._units, pairs, strict=True)
        ]
        return [*(_dot(widest, _vector(axis)) for axis in AXES), *faces]  # Babylon refuses math/extract3

    def _edges(self, k: int) -> Expression:
        """The same of the three axes e x b (float3), where b is the second box's axis ``k``.

        Of its other axes one crosses b to the other: |b x c| = |d|.
        """
        unit, one, other = self._units[k], (k + 1) % 3, (k + 2) % 3
        gaps = _size(binary("math/cross", "float3", unit, self._place))
        gaps = gaps - Expression("float3", "math/transform", {"a": self._sizes[k], "b": self._swept.value})
        gaps = gaps - self._sizes[other] * self._halves[one].value - self._sizes[one] * self._halves[other].value
        across = binary("math/max", "float3", _vector(np.ones(3)) - unit * unit, _vector(np.zeros(3)))
        return gaps - unary("math/sqrt", across) * self._distance.value


def _variable(name: str, initial: NDArray[np.float64]) -> GraphVariable:
    return GraphVariable(f"box {name}", constant(f"float{len(initial)}", *initial.tolist()))


def _gap(first: BodyBox, second: BodyBox) -> Expression:
    """From the middle of one to that of the other, in the world (float4)."""
    return carried(second.row, np.append(second.middle, 1.0)) - carried(first.row, np.append(first.middle, 1.0))


def _axes(row: int) -> list[Expression]:
    """The axes of an entity in the world, at length 1 (float4)."""
    return [unary("math/normalize", carried(row, np.append(axis, 0.0))) for axis in AXES]


def _seen(vector: Expression, axes: list[Expression]) -> Expression:
    """A direction of the world (float4) in some axes (float3)."""
    parts = [_dot(vector, axis) for axis in axes]
    return Expression("float3", "math/combine3", dict(zip("abc", parts, strict=True)))


def _dot(first: Expression, second: Expression) -> Expression:
    return binary("math/dot", "float", first, second)


def _size(value: Expression) -> Expression:
    return unary("math/abs", value)


def _vector(numbers: NDArray[np.float64]) -> Expression:
    return constant("float3", *numbers.tolist())


def _sum(values: list[Expression]) -> Expression:
    result = values[0]
    for value in values[1:]:
        result = result + value
    return result
