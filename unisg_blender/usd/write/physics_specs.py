"""Rigid bodies as UsdPhysics, and categories as semantic labels: what simulators read without a repair script."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from pxr import Sdf

from ...scene import components
from ...scene.graph import SceneGraph
from .. import schema
from ..names import clean
from .specs import Types, attribute

LABELS = "SemanticsLabelsAPI:category"
APPROXIMATIONS = {
    "box": "boundingCube", "hull": "convexHull", "mesh": "none", "sphere": "boundingSphere", "capsule": "convexHull",
    "cylinder": "convexHull", "cone": "convexHull",
}  # fmt: skip
"""What stands for a mesh in collisions; UsdPhysics has no capsules, cylinders or cones around meshes."""


def write_labels(prim: Any, category: str) -> None:
    """The category as a label of the taxonomy "category"."""
    also_apply(prim, LABELS)
    attribute(prim, schema.LABELS, Types.TokenArray, [clean(category)], uniform=False)


def write_physics(prims: Sequence[Any], graph: SceneGraph) -> None:
    """Bodies and colliders of the entities with the component ``rigid_bodies``; ``prims`` are theirs by row."""
    found = graph.components.get(components.RIGID_BODIES)
    if found is None:
        return
    names = ("kind", "shape", "mass")
    entries = {row: values for row, *values in graph.entries(components.RIGID_BODIES, *names)}
    body = [-1] * len(graph)
    for row, parent in enumerate(graph.parent.tolist()):  # parents come first
        body[row] = row if row in entries else body[parent] if parent >= 0 else -1
        if row in entries and entries[row][0] == "active":
            also_apply(prims[row], "PhysicsRigidBodyAPI", "PhysicsMassAPI")
            attribute(prims[row], "physics:mass", Types.Float, float(entries[row][2]), uniform=False)
        if body[row] >= 0 and graph.mesh[row] >= 0:
            _collide(prims[row], APPROXIMATIONS.get(entries[body[row]][1], "convexHull"))


def _collide(prim: Any, approximation: str) -> None:
    """Make the mesh below an entity's prim collide."""
    for shape in _meshes(prim):
        also_apply(shape, "PhysicsCollisionAPI", "PhysicsMeshCollisionAPI")
        attribute(shape, "physics:approximation", Types.Token, approximation)


def _meshes(prim: Any) -> Iterator[Any]:
    return (child for child in prim.nameChildren if child.typeName == "Mesh")


def also_apply(prim: Any, *names: str) -> None:
    """Apply API schemas to a prim beside those that it has."""
    known = prim.GetInfo("apiSchemas").prependedItems if prim.HasInfo("apiSchemas") else []
    prim.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=[*known, *names]))
