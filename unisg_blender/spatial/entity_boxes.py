"""Oriented boxes around entities: the size of objects, for relations, metrics and generation."""

from __future__ import annotations

from dataclasses import replace

from ..geometry.boxes import Boxes, boxes_around, orthonormal_axes
from ..scene.graph import SceneGraph
from ..scene.hierarchy import local_bounds, world_matrices


def oriented_boxes(graph: SceneGraph) -> Boxes:
    """World-space oriented boxes of all entities.

    The axes are the object's own, made orthonormal one after another where scale
    and shear bend them (the box then still contains the mesh).
    """
    world = world_matrices(graph)
    boxes = boxes_around(local_bounds(graph), world, orthonormal_axes(world[:, :3, :3]))
    return replace(boxes, solid=graph.mesh >= 0)
