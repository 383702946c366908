"""A scene as simulators want it: bodies that move beside one another, the building firm, each with mass and shape."""

from __future__ import annotations

import numpy as np

from ...errors import UniSGError
from ...scene.assembly import canonical
from ...scene.component_table import table
from ...scene.components import RIGID_BODIES
from ...scene.graph import SceneGraph
from ...scene.hierarchy import without_world, world_matrices
from .body_mass import mass_of
from .moving_bodies import rigid_bodies

SHAPES = ("box", "hull", "mesh")
"""What may be asked for; a mesh that moves is its hull, as simulators want it."""

FRICTION, RESTITUTION = 0.7, 0.0


def simulated_scene(graph: SceneGraph, shape: str = "hull") -> SceneGraph:
    """The scene with rigid bodies (:data:`~...scene.components.RIGID_BODIES`), where it has none yet.

    Things that move are no longer parts of what they stand on, which simulators do not allow: the relations
    tell that. What hangs from a thing stays below it. The building, and what is fixed to it, does not move, and is of
    meshes; ``shape``, one of :data:`SHAPES`, is that of all others.

    Raises
    ------
    UniSGError
        For another shape.
    """
    if shape not in SHAPES:
        raise UniSGError(f"there is no shape {shape!r} of bodies: give one of {', '.join(SHAPES)}")
    if RIGID_BODIES in graph.components:
        return graph
    bodies = rigid_bodies(graph)
    rows: list[int] = []
    kinds: list[str] = []
    shapes: list[str] = []
    masses: list[float] = []
    parent, local, world = graph.parent.copy(), graph.local.copy(), world_matrices(graph)
    for body in bodies:
        fixed = body.row < 0
        own = body.meshes.tolist() if fixed else [body.row]
        rows += own
        kinds += ["passive" if fixed else "active"] * len(own)
        shapes += ["mesh" if fixed else "hull" if shape == "mesh" else shape] * len(own)
        masses += [0.0 if fixed else mass_of(graph, body.meshes.tolist())] * len(own)
        for row in () if fixed else body.objects.tolist():
            parent[row] = -1 if row == body.row else body.row
            local[row] = world[row] if row == body.row else np.linalg.solve(world[body.row], world[row])
    count = len(rows)
    found = table(
        rows, kind=kinds, shape=shapes, mass=np.array(masses, float), friction=np.full(count, FRICTION),
        restitution=np.full(count, RESTITUTION),
    )  # fmt: skip
    moved = np.flatnonzero(parent != graph.parent).tolist()
    free = without_world(graph, moved).replace(parent=parent, local=local)
    return canonical(free.with_component(RIGID_BODIES, found))
