"""Whether entities are where actions want them, as values of a graph.

Positions and directions are float4 (a point ends in 1, a direction in 0), since players differ in what they do with a
matrix but to transform vectors by it. The turn between two rotations u, v is asked for by the chord
``|u - v|^2 = 8 sin(angle / 2)^2`` of their columns, which is exact for small angles too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..behaviour.fulfilment.action_batch import Batch
from ..behaviour.fulfilment.body_contact import EPSILON
from .behaviour_program import Expression, binary, constant, real, unary

ORIGIN = np.array([0.0, 0.0, 0.0, 1.0])
MIRRORED = -1.0


def world_matrix(node: int) -> Expression:
    """The matrix of a node to the world."""
    return Expression(
        "float4x4", "pointer/get", configuration={"node": node, "pointer": "globalMatrix", "type": "float4x4"}
    )


def carried(node: int, vector: NDArray[np.float64]) -> Expression:
    """A constant float4 out of a node's frame into the world; -1 is the world."""
    value = constant("float4", *vector.tolist())
    return value if node < 0 else Expression("float4", "math/transform", {"a": value, "b": world_matrix(node)})


def total(values: list[Expression]) -> Expression:
    """The sum of values."""
    result = values[0]
    for value in values[1:]:
        result = result + value
    return result


class PoseConditions:
    """The conditions of a batch of actions that compare poses.

    ``mirrored`` bool (N,): entities whose world matrix mirrors; their columns are turned around, as rotations are told.
    References are in glTF's axes, float64 (P, 4, 4).
    """

    def __init__(self, batch: Batch, references: NDArray[np.float64], mirrored: NDArray[np.bool_]) -> None:
        self._poses, self._references, self._mirrored = batch.poses, references, mirrored

    def pairs(self, action: int) -> Iterator[int]:
        """Numbers of the pairs of an action and one of its entities."""
        yield from np.flatnonzero(self._poses.action == action).tolist()

    def there(self, pair: int) -> list[Expression]:
        """What must hold for the entity to be within distance and angle."""
        near = [self._distance(pair) <= real(limit)] if math.isfinite(limit := self._limit(pair)) else []
        turn = self._bound(pair)
        return [*near, *([] if turn is None else [self._chord(pair) <= real(turn)])]

    def away(self, pair: int) -> list[Expression]:
        """Of which one must hold for it to be farther, or turned by more."""
        far = [self._distance(pair) > real(limit)] if math.isfinite(limit := self._limit(pair)) else []
        turn = self._bound(pair)
        return [*far, *([] if turn is None else [self._chord(pair) > real(turn)])]

    def _limit(self, pair: int) -> float:
        return float(self._poses.distance[pair]) + EPSILON

    def _bound(self, pair: int) -> float | None:
        """The square of the chord that the angle allows; None where every turn is allowed."""
        angle = float(self._poses.angle[pair]) + EPSILON
        return 8 * math.sin(angle / 2) ** 2 if self._poses.turns[pair] and angle < math.pi else None

    def _distance(self, pair: int) -> Expression:
        own = carried(int(self._poses.row[pair]), ORIGIN)
        wanted = carried(int(self._poses.frame[pair]), self._references[pair][:, 3])
        return unary("math/length", own - wanted, "float")

    def _chord(self, pair: int) -> Expression:
        row, frame, reference = int(self._poses.row[pair]), int(self._poses.frame[pair]), self._references[pair]
        flip = (np.linalg.det(reference[:3, :3]) < 0) ^ (frame >= 0 and bool(self._mirrored[frame]))
        own = self._columns(row, np.eye(4)[:, :3], bool(self._mirrored[row]))
        wanted = self._columns(frame, reference[:, :3], bool(flip))
        gaps = [one - other for one, other in zip(own, wanted, strict=True)]
        return total([binary("math/dot", "float", gap, gap) for gap in gaps])

    def _columns(self, node: int, columns: NDArray[np.float64], flip: bool) -> list[Expression]:
        """Three directions in the world, at length 1."""
        sign = MIRRORED if flip else 1.0
        return [unary("math/normalize", carried(node, column * sign)) for column in columns.T]
