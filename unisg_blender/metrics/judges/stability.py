"""Do things stay where they are? A scene is simulated under gravity in MuJoCo.

Things are the convex pieces of their connected parts, concave ones decomposed by CoACD if it is installed. The
building does not move: each of its triangles near a thing is a thin prism behind its face. SceneSmith (2026) measures
its scenes likewise.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from typing import Any

import numpy as np

from ...errors import MissingPackageError
from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.corner_ends import corner_ends
from ...scene.graph import SceneGraph
from ...scene.hierarchy import world_matrices
from ...spatial.bodies import RigidBody, convex_pieces, rigid_bodies
from ...spatial.bodies.body_mass import density_of
from ...spatial.bodies.hull_pieces import face_prism
from ...spatial.structure.scan import world_triangles

SECONDS, STEP = 2.0, 0.002
STILL, UPRIGHT = 0.02, np.radians(5.0)
"""Metres and radians that a thing may move and turn to count as stable."""

BEHIND, NEAR, LEVEL = 0.05, 0.4, 0.3
"""Metres that a triangle of the building is thick; and around things in which its triangles are there; and upward part
of the normal of what bears things, whichever way it looks."""

FINENESS, PIECES = 0.05, 24
"""CoACD's threshold of concavity, and the most pieces of a part."""

QUICK = {"mcts_iterations": 20, "mcts_nodes": 10, "mcts_max_depth": 1, "resolution": 500, "preprocess_mode": "off"}
"""How hard CoACD looks for good cuts: as little as it may."""

ENTERED = 0.002
"""Metres by which a thing reaches into the box of another to be in it."""


@dataclass(frozen=True, eq=False)
class Stability:
    """Rows (B,) of the free things, and metres (B,) and radians (B,) that each moved and turned."""

    rows: Ints
    moved: Floats
    turned: Floats

    @property
    def stays(self) -> Bools:
        """Which of them stay."""
        return np.asarray((self.moved <= STILL) & (self.turned <= UPRIGHT))


def simulated(graph: SceneGraph, fixed: Collection[int] = (), seconds: float = SECONDS) -> Stability:
    """A scene under gravity for some seconds; nothing of it is changed.

    Parameters
    ----------
    graph
        The scene, metres, z up.
    fixed
        Rows of objects that are taken as building.

    Raises
    ------
    MissingPackageError
        If MuJoCo is not installed.
    """
    mujoco = require_mujoco()
    bodies = rigid_bodies(graph, fixed)
    free, world = [body for body in bodies[1:] if len(body.meshes)], world_matrices(graph)
    model = _spec(mujoco, graph, bodies, world).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    numbers = [model.body(_name(body)).id for body in free]
    before = data.xpos[numbers].copy(), data.xmat[numbers].reshape(-1, 3, 3).copy()
    for _ in range(round(seconds / STEP)):
        mujoco.mj_step(model, data)
    moved = np.linalg.norm(data.xpos[numbers] - before[0], axis=1)
    turn = np.einsum("nij,nij->n", data.xmat[numbers].reshape(-1, 3, 3), before[1])
    turned = np.arccos(np.clip((turn - 1) / 2, -1, 1))
    return Stability(np.array([body.row for body in free], np.int64), moved, turned)


def require_mujoco() -> Any:
    """MuJoCo; MissingPackageError where it is not installed."""
    try:
        import mujoco
    except ImportError:
        raise MissingPackageError("mujoco", "judge") from None
    return mujoco


def _name(body: RigidBody) -> str:
    return f"body {body.row}"


def _spec(mujoco: Any, graph: SceneGraph, bodies: list[RigidBody], world: Floats) -> Any:
    """The model: a body with a free joint for each that moves, its frame in the middle of its points."""
    spec = mujoco.MjSpec()
    spec.option.timestep = STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    free = [body for body in bodies[1:] if len(body.meshes)]
    ends = np.array([_ends(graph, body, world) for body in free]).reshape(-1, 2, 3)
    entered = _entered(ends)
    for number, body in enumerate(free):
        middle = ends[number].mean(axis=0)
        added = spec.worldbody.add_body(name=_name(body), pos=middle)
        added.add_freejoint()
        decompose, count = _decomposer() if entered[number] else None, 0
        for row in body.meshes.tolist():
            matrix, density = world[row], density_of(graph, row)
            for points in convex_pieces(graph.meshes[graph.mesh[row]], decompose):
                moved = points @ matrix[:3, :3].T + matrix[:3, 3] - middle
                _add_piece(mujoco, spec, added, f"{_name(body)} {count}", moved, density)
                count += 1
    _add_building(mujoco, spec, graph, bodies[0], ends[:, 0], ends[:, 1])
    return spec


def _ends(graph: SceneGraph, body: RigidBody, world: Floats) -> Floats:
    """Lowest and highest corner (2, 3) of a body along the world's axes."""
    points = np.concatenate([
        graph.meshes[graph.mesh[row]].points @ world[row, :3, :3].T + world[row, :3, 3] for row in body.meshes
    ])  # fmt: skip
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _entered(ends: Floats) -> Bools:
    """Into which of some boxes (B, 2, 3) others reach: only there it matters that a thing is hollow."""
    deep = np.minimum(ends[:, None, 1], ends[None, :, 1]) - np.maximum(ends[:, None, 0], ends[None, :, 0])
    hit = (deep > ENTERED).all(axis=2)
    np.fill_diagonal(hit, False)
    return np.asarray(hit.any(axis=1))


def _add_piece(mujoco: Any, spec: Any, body: Any, name: str, points: Floats, density: float) -> None:
    spec.add_mesh(name=name, uservert=points.ravel())
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, density=density)


def _add_building(mujoco: Any, spec: Any, graph: SceneGraph, still: RigidBody, low: Floats, high: Floats) -> None:
    """The triangles of what does not move that are near things."""
    triangles, owner = world_triangles(graph)
    triangles = triangles[np.isin(owner, still.meshes)]
    least, most = corner_ends(triangles)
    for number, triangle in enumerate(triangles):
        near = ((low - NEAR <= most[number]) & (high + NEAR >= least[number])).all(axis=1)
        prism = _prism(triangle, ((low + high) / 2)[near]) if near.any() else None
        if prism is not None:
            _add_piece(mujoco, spec, spec.worldbody, f"building {number}", prism, 1000.0)


def _prism(triangle: Floats, things: Floats) -> Floats | None:
    """A triangle (3, 3) with its thickness on the side where things (K, 3) are not; None where it has no area."""
    normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
    slope = normal[2] / max(float(np.linalg.norm(normal)), 1e-12)
    above = slope if abs(slope) > LEVEL else float(np.sign((things - triangle[0]) @ normal).sum())
    return face_prism(triangle if above >= 0 else triangle[::-1], BEHIND)


@cache
def _decomposer() -> Any:
    """CoACD as a :data:`~...spatial.bodies.convex_pieces.Decompose`; None where it is not installed."""
    if find_spec("coacd") is None:
        return None
    import coacd

    coacd.set_log_level("error")

    def decompose(points: Floats, triangles: Ints) -> list[Floats]:
        """The pieces of a closed mesh."""
        mesh = coacd.Mesh(points, triangles)
        found = coacd.run_coacd(mesh, threshold=FINENESS, max_convex_hull=PIECES, seed=0, **QUICK)
        return [np.asarray(vertices) for vertices, _ in found]

    return decompose
