"""Rigid bodies of UsdPhysics; what our own table says of an entity counts, where it has one."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...scene import components
from ...scene.component_table import Table, table
from .entity_selection import Entities

BODY, MASS, COLLIDER, COLLIDER_MESH = (
    "PhysicsRigidBodyAPI", "PhysicsMassAPI", "PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"
)  # fmt: skip
SHAPES = {"boundingCube": "box", "convexHull": "hull", "convexDecomposition": "mesh", "boundingSphere": "sphere"}
"""Shapes by how a mesh is approximated; any other way is the mesh itself."""

USUAL = {"friction": 0.5, "restitution": 0.0}


def read_bodies(found: Entities, tables: dict[str, Table], kilograms: float = 1.0) -> dict[str, Table]:
    """The component ``rigid_bodies``, if there are any bodies; ``kilograms`` is a unit of mass of the stage.

    A collider that is in no body that moves is a passive body by itself.
    """
    if components.RIGID_BODIES in tables:
        return {}
    moves = [_has(prim, BODY) for prim in found.prim]
    inside = list(moves)
    for row, parent in enumerate(found.parent):  # parents come first
        inside[row] = inside[row] or (parent >= 0 and inside[parent])
    entries = []
    for row, (prim, shape) in enumerate(zip(found.prim, found.shape, strict=True)):
        collides = _collides(prim) or (shape is not None and _collides(shape))
        if moves[row] or (collides and not inside[row]):
            kind = "active" if moves[row] else "passive"
            entries.append((row, kind, _shape(found, row), _mass(prim) * kilograms))
    if not entries:
        return {}
    rows, kinds, shapes, masses = zip(*entries, strict=True)
    columns = {name: np.full(len(rows), value) for name, value in USUAL.items()}
    bodies = table(rows, kind=kinds, shape=shapes, mass=np.array(masses, float), **columns)
    return {components.RIGID_BODIES: bodies}


def _has(prim: Any, name: str) -> bool:
    return name in prim.GetAppliedSchemas()


def _collides(prim: Any) -> bool:
    return _has(prim, COLLIDER)


def _mass(prim: Any) -> float:
    """What is said of a body's mass, 0 where it is left to the simulator."""
    value = prim.GetAttribute("physics:mass").Get() if _has(prim, MASS) else None
    return float(value) if isinstance(value, float) and np.isfinite(value) and value > 0 else 0.0


def _shape(found: Entities, row: int) -> str:
    """The shape of the first collider of a body: its own, or one below."""
    for other in range(row, len(found.prim)):
        above = other
        while above > row:
            above = found.parent[above]
        for prim in (found.shape[other], found.prim[other]) if above == row else ():
            if prim is not None and _collides(prim):
                value = prim.GetAttribute("physics:approximation").Get() if _has(prim, COLLIDER_MESH) else "none"
                return SHAPES.get(str(value), "mesh")
    return "mesh"
