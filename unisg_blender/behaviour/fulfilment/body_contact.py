"""Contact between bodies: oriented boxes that touch, or come near enough."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.affine_rows import Array, rotation_and_size, transform
from ...geometry.box_distance import separation
from ...geometry.box_distance_bounds import plainly_near
from ...geometry.boxes import SIGNS, Boxes, orthonormal_axes
from ...scene import local_bounds
from ...scene.graph import SceneGraph
from ...scene.hierarchy import subtree, world_matrices

EPSILON = 1e-9
"""Metres and radians by which a limit may be missed by rounding: at the exact threshold, the rule decides."""


def body_bounds(graph: SceneGraph, rows: NDArray[np.integer]) -> Array:
    """Box of each row's body in its own frame, float64 (6, K): its middle and its half extents, in metres.

    The body is the entity's mesh, or without one all meshes below it; a row with no
    mesh at or below it is a point.
    """
    bounds, world = local_bounds(graph), world_matrices(graph)
    found = bounds[rows]
    for place, row in enumerate(rows):
        if graph.mesh[row] >= 0:
            continue
        below = subtree(graph, int(row))
        below = below[graph.mesh[below] >= 0]
        if len(below):
            middle, half = bounds[below].mean(axis=1), (bounds[below, 1] - bounds[below, 0]) / 2
            corners = middle[:, None] + SIGNS * half[:, None]
            local = np.linalg.pinv(world[row]) @ world[below]
            points = np.einsum("kij,kcj->kci", local[:, :3, :3], corners) + local[:, None, :3, 3]
            found[place] = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    low, high = found[:, 0].T, found[:, 1].T
    return np.concatenate([(low + high) / 2, (high - low) / 2])


def bodies_at(pose: Array, bounds: Array) -> Boxes:
    """Bodies at world poses (12, K) with boxes (6, K) in their own frames, see :func:`body_bounds`."""
    columns, size, straight = rotation_and_size(pose)
    axes, half = columns.reshape(3, 3, -1).transpose(2, 1, 0).copy(), (size * bounds[3:]).T.copy()
    if not straight.all():  # shear: the axes are made orthonormal, the box still contains the body
        bent = np.flatnonzero(~straight & np.isfinite(pose).all(axis=0))
        linear = pose[:, bent].reshape(3, 4, -1).transpose(2, 0, 1)[:, :, :3]
        axes[bent] = orthonormal_axes(linear)
        half[bent] = np.einsum("kij,jk->ki", np.abs(np.swapaxes(axes[bent], 1, 2) @ linear), bounds[3:, bent])
    return Boxes(transform(pose, bounds[:3]).T, axes, half, np.ones(len(half), bool))


def touching(
    first: Array, first_bounds: Array, second: Array, second_bounds: Array, distance: Array
) -> NDArray[np.bool_]:
    """Whether body k of ``first`` comes within ``distance[k]`` metres of body k of ``second``; bool (K,).

    Both are given by their world poses (12, K) and their boxes (6, K) in their own frames.
    """
    near, apart = plainly_near(first, first_bounds, second, second_bounds, distance)
    doubt = np.flatnonzero(~(near | apart))
    if len(doubt):
        one = bodies_at(first.take(doubt, 1), first_bounds.take(doubt, 1))
        other = bodies_at(second.take(doubt, 1), second_bounds.take(doubt, 1))
        near[doubt] = _touching_exactly(one, other, distance[doubt] + EPSILON)
    return near


def _touching_exactly(first: Boxes, second: Boxes, distance: Array) -> NDArray[np.bool_]:
    """Overlap by separating axes, and the exact distance of what is apart."""
    from ...geometry.box_overlap import penetration  # loads scipy, which panels can do without

    depth = penetration(first, second)
    result: NDArray[np.bool_] = depth >= -EPSILON
    rows = np.flatnonzero(~result & (depth >= -distance))  # at corners the distance may be more than -depth
    result[rows] = separation(first.take(rows), second.take(rows)) <= distance[rows]
    return result
