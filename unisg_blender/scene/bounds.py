"""Oriented boxes around entities: the size of things, for relations, metrics and generation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .graph import SceneGraph
from .hierarchy import world_matrices


@dataclass(frozen=True, eq=False)
class Boxes:
    """Oriented boxes in the world, one per row.

    ``center`` (N, 3) metres; ``axes`` (N, 3, 3) orthonormal, axis k is the column
    ``axes[:, :, k]``; ``half`` (N, 3) half extents along them in metres; ``solid``
    bool (N,): False for rows without geometry (their box is a point).
    """

    center: NDArray[np.float64]
    axes: NDArray[np.float64]
    half: NDArray[np.float64]
    solid: NDArray[np.bool_]

    def take(self, rows: NDArray[np.integer]) -> Boxes:
        """The boxes of some rows."""
        return Boxes(self.center[rows], self.axes[rows], self.half[rows], self.solid[rows])


def turned_reach(half: NDArray[np.float64], turn: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """Half extents (..., 2) along x and y of a box of half extents (3,) that is turned by angles (...), radians."""
    cos, sin = np.abs(np.cos(turn)), np.abs(np.sin(turn))
    return np.stack([cos * half[0] + sin * half[1], sin * half[0] + cos * half[1]], axis=-1)


def local_bounds(graph: SceneGraph) -> NDArray[np.float64]:
    """Boxes of the meshes in their own frames, float64 (N, 2, 3) lowest and highest corner; zeros without a mesh."""
    table = np.zeros((len(graph.meshes) + 1, 2, 3))
    for index, mesh in enumerate(graph.meshes):
        table[index] = mesh.bounds
    return table[graph.mesh]


def oriented_boxes(graph: SceneGraph) -> Boxes:
    """World-space oriented boxes of all entities.

    The axes are the object's own, made orthonormal one after another where scale
    and shear bend them (the box then still contains the mesh).
    """
    world, bounds = world_matrices(graph), local_bounds(graph)
    middle, half = bounds.mean(axis=1), (bounds[:, 1] - bounds[:, 0]) / 2
    linear = world[:, :3, :3]
    axes = orthonormal_axes(linear)
    spread = np.abs(np.swapaxes(axes, 1, 2) @ linear)  # extent along our axes of a unit step along each local axis
    return Boxes(
        center=world[:, :3, 3] + np.einsum("nij,nj->ni", linear, middle),
        axes=axes,
        half=np.einsum("nij,nj->ni", spread, half),
        solid=graph.mesh >= 0,
    )


def orthonormal_axes(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """Right-handed orthonormal axes (N, 3, 3) along the columns of ``linear``; world axes where a column vanishes."""
    axes, triangular = np.linalg.qr(linear)
    diagonal = np.einsum("nii->ni", triangular)
    axes = axes * np.where(diagonal < 0, -1.0, 1.0)[:, None, :]
    flipped = np.linalg.det(axes) < 0
    axes[flipped, :, 2] *= -1
    scale = np.abs(diagonal)
    broken = scale.min(axis=1, initial=np.inf) <= 1e-12 * np.maximum(scale.max(axis=1, initial=0), 1e-300)
    axes[broken] = np.eye(3)
    return axes
