"""Quick answers to "do these boxes come that near?": right where they are given, and given for nearly all.

From a point of one box to the nearest point of the other, and back from there: if the
two are near enough, the boxes are; if all of the first box lies too far beyond, seen
along the line between them, they are not. What is left open, and what is too close to call, is
for the exact test in :mod:`..behaviour.fulfilment.body_contact`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .affine_rows import Array, column_products, determinant, dot, length, linear, some, transform
from .arrays import Bools

_ROUNDS = 2
_SKEW = 1e-12
"""By this much less than 1 may the volume of columns of length 1 be: they are askew by at most 2e-6."""

_SLACK = 1e-5
"""Part of the sizes and the distance within which nothing is decided: more than skew and rounding can change."""


@dataclass(frozen=True, eq=False)
class Bricks:
    """K boxes in the world, components first: ``center`` (3, K), ``axes`` (3, 3, K) as columns, ``half`` (3, K)."""

    center: Array
    axes: Array
    half: Array

    def take(self, places: NDArray[np.integer]) -> Bricks:
        """Some of the boxes."""
        return Bricks(
            some(self.center, places),
            some(self.axes.reshape(9, -1), places).reshape(3, 3, -1),
            some(self.half, places),
        )


def sphere(pose: Array, bounds: Array) -> tuple[Array, Array]:
    """Centres (3, K) and radii (K,) of spheres around the bodies, whatever their scale and shear."""
    matrix = linear(pose)
    stretch = np.sqrt(np.einsum("ijk,ijk->k", matrix, matrix))
    return transform(pose, bounds[:3]), stretch * length(bounds[3:])


def plainly_near(
    first: Array, first_bounds: Array, second: Array, second_bounds: Array, distance: Array
) -> tuple[Bools, Bools]:
    """Where bodies plainly come within ``distance`` of each other, and where they plainly do not; both bool (K,).

    Poses (12, K) and boxes (6, K) are those of :func:`..behaviour.fulfilment.body_contact.touching`.
    """
    center, radius = sphere(first, first_bounds)
    other_center, other_radius = sphere(second, second_bounds)
    size = radius + other_radius + distance
    apart = length(center - other_center) > size * (1 + _SLACK)
    near = np.zeros(len(apart), bool)
    rows = np.flatnonzero(~apart)
    if len(rows):
        one, straight = _bricks(some(first, rows), center.take(rows, 1), first_bounds[3:].take(rows, 1))
        two, other = _bricks(some(second, rows), other_center.take(rows, 1), second_bounds[3:].take(rows, 1))
        near[rows], apart[rows] = _there_and_back(one, two, distance[rows], _SLACK * size[rows], straight & other)
    return near, apart


def _bricks(pose: Array, center: Array, half: Array) -> tuple[Bricks, Bools]:
    """The boxes, and for which of them the columns of the pose can serve as axes."""
    matrix = linear(pose)
    with np.errstate(all="ignore"):
        size = np.sqrt(column_products(matrix, matrix))
        axes = matrix / size
        straight = np.abs(determinant(axes)) >= 1.0 - _SKEW
    return Bricks(center, axes, size * half), straight


def _there_and_back(to: Bricks, of: Bricks, distance: Array, slack: Array, sound: Bools) -> tuple[Bools, Bools]:
    """Near and apart, as :func:`plainly_near`; only the ``sound`` are looked at."""
    near, apart = np.zeros(len(sound), bool), np.zeros(len(sound), bool)
    rows = np.flatnonzero(sound)
    of, to, point = of.take(rows), to.take(rows), some(to.center, rows)
    distance, slack = distance[rows], slack[rows]
    for _ in range(_ROUNDS):
        beyond, way = _way_out(of, point)
        gap = length(way)
        reached = (gap + slack <= distance) | (beyond <= -slack)
        point = point - way
        seen = np.abs(np.einsum("ijk,ik->jk", to.axes, way))
        clear = dot(way, to.center - point) - dot(seen, to.half) > (distance + slack) * gap
        near[rows], apart[rows] = reached, clear & ~reached
        left = np.flatnonzero(~(reached | clear))
        if not len(left):
            break
        rows, distance, slack = rows[left], distance[left], slack[left]
        of, to, point = to.take(left), of.take(left), some(point, left)
    return near, apart


def _way_out(boxes: Bricks, points: Array) -> tuple[Array, Array]:
    """How far beyond the nearest side points are (K,), negative inside, and the way (3, K) from the box to them."""
    seen = np.einsum("ijk,ik->jk", boxes.axes, points - boxes.center)
    beyond = np.abs(seen) - boxes.half
    outside = np.copysign(np.maximum(beyond, 0.0), seen)
    return beyond.max(axis=0), np.einsum("ijk,jk->ik", boxes.axes, outside)
