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
from .pose_conditions import ORIGIN, world_matrix

AXES = np.eye(3)


class BodyBox(NamedTuple):
    """The box of an entity's body: its row, middle (3,) in its own frame, half extents (3,) in metres of the world.

    In glTF's axes.
    """

    row: int
    middle: NDArray[np.float64]
    half: NDArray[np.float64]


class BoxTest:
    """The test of two boxes, and the variables that it is about.

    :meth:`about` fills them; then ``near`` is whether the balls around the boxes come within the distance, ``touching``
    whether no axis parts the boxes by more.
    """

    def __init__(self) -> None:
        self._poses = [GraphVariable(f"box pose {k}", constant("float4x4", *np.eye(4).ravel())) for k in range(2)]
        self._middles = [_variable(f"middle {k}", ORIGIN) for k in range(2)]
        self._half, self._other_half = (_variable(name, np.zeros(3)) for name in ("half", "other half"))
        self._swept = GraphVariable("box swept", constant("float3x3", *[0.0] * 9))
        self._reach, self._distance = (GraphVariable(f"box {name}", real(0)) for name in ("reach", "distance"))
        mine, others = (
            [unary("math/normalize", _out_of(pose, _vector(np.append(axis, 0.0)))) for axis in AXES]
            for pose in self._poses
        )
        gap = _out_of(self._poses[1], self._middles[1].value) - _out_of(self._poses[0], self._middles[0].value)
        self.near = _dot(gap, gap) <= self._reach.value
        self._place = _seen(gap, mine)
        self._units = [_seen(axis, mine) for axis in others]
        self._sizes = [_size(unit) for unit in self._units]
        self._halves = [_each(self._other_half.value, axis) for axis in AXES]
        self._apart = Expression("float3", "math/combine3", dict.fromkeys("abc", self._distance.value))
        self.touching = all_of(gap <= real(EPSILON) for gap in self._parted())

    @property
    def variables(self) -> tuple[GraphVariable, ...]:
        """What it is about."""
        sizes = (self._half, self._other_half, self._swept, self._reach, self._distance)
        return (*self._poses, *self._middles, *sizes)

    def about(self, first: BodyBox, second: BodyBox, distance: float) -> Put:
        """Let it be about two boxes and how near they have to come."""
        x, y, z = first.half.tolist()
        reach = np.linalg.norm(first.half) + np.linalg.norm(second.half) + distance + EPSILON
        return put(
            *((pose, world_matrix(box.row)) for pose, box in zip(self._poses, (first, second), strict=True)),
            *((kept, _vector(np.append(box.middle, 1.0)))
              for kept, box in zip(self._middles, (first, second), strict=True)),
            (self._half, _vector(first.half)),
            (self._other_half, _vector(second.half)),
            (self._swept, constant("float3x3", 0.0, z, y, z, 0.0, x, y, x, 0.0)),  # sums of half extents times |b x e|
            (self._reach, real(float(reach) ** 2)),
            (self._distance, real(distance)),
        )  # fmt: skip

    def _parted(self) -> list[Expression]:
        """By how much the axes part the boxes beyond the distance, the largest of each kind."""
        half, distance = self._half.value, self._apart
        pairs = list(zip(self._sizes, self._halves, strict=True))
        widest = _size(self._place) - half - distance - _sum([size * kept for size, kept in pairs])
        for k in range(3):
            widest = binary("math/max", "float3", widest, self._edges(k))
        faces = [
            _size(_dot(self._place, unit)) - _dot(half, size) - _dot(kept + distance, _vector(AXES[0]))
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
        gaps = gaps - self._sizes[other] * self._halves[one] - self._sizes[one] * self._halves[other]
        across = binary("math/max", "float3", _vector(np.ones(3)) - unit * unit, _vector(np.zeros(3)))
        return gaps - unary("math/sqrt", across) * self._apart


def _variable(name: str, initial: NDArray[np.float64]) -> GraphVariable:
    return GraphVariable(f"box {name}", constant(f"float{len(initial)}", *initial.tolist()))


def _out_of(pose: GraphVariable, vector: Expression) -> Expression:
    """A vector of a box's frame in the world (float4)."""
    return Expression("float4", "math/transform", {"a": vector, "b": pose.value})


def _each(vector: Expression, axis: NDArray[np.float64]) -> Expression:
    """One number of a vector (float3), three times."""
    return Expression("float3", "math/transform", {"a": vector, "b": constant("float3x3", *axis.repeat(3).tolist())})


def _seen(vector: Expression, axes: list[Expression]) -> Expression:
    """A direction of the world (float4) in some axes (float3)."""
    parts = [_dot(vector, axis) for axis in axes]
    return Expression("float3", "math/combine3", dict(zip("abc", parts, strict=True)))


def _dot(first: Expression, second: Expression) -> Expression:
    return binary("math/dot", "float", first, second)


def _size(value: Expression) -> Expression:
    return unary("math/abs", value)


def _vector(numbers: NDArray[np.float64]) -> Expression:
    return constant(f"float{len(numbers)}", *numbers.tolist())


def _sum(values: list[Expression]) -> Expression:
    result = values[0]
    for value in values[1:]:
        result = result + value
    return result
