"""Oriented boxes around entities: the size of objects, for relations, metrics and generation."""

from __future__ import annotations

import numpy as np

from ..geometry.boxes import Boxes, orthonormal_axes
from ..scene.graph import SceneGraph
from ..scene.hierarchy import local_bounds, world_matrices


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
