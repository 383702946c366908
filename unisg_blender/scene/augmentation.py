"""Augmentation: new scenes out of one, by small noise on its components and by symmetry. The source is never changed.

The paper adds noise to the components of its scenes; here noise lives where the
components do: on poses in the tangent space (metres, radians), on scales as
factors, on meshes along their normals. All functions are pure: graph and seed in,
new graph out. Actions, lessons, relations and uids stay as they are; where poses
are moved in a way that reference poses would notice, those are moved along.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..poses import exp
from .action_data import ActionData
from .categories import STRUCTURE, has_category
from .component_table import Table, table
from .graph import SceneGraph
from .hierarchy import take
from .mesh import Mesh
from .parents import with_rows_below

Matrix = NDArray[np.float64]

FIXED = (*STRUCTURE, "Ceiling Rail")
"""Categories that noise leaves alone unless asked otherwise: the building, and the rail that is screwed to it."""


def pose_noise(
    graph: SceneGraph, seed: int, *, metres: float = 0.02, radians: float = 0.03, upright: bool = False,
    fixed: Collection[str] = FIXED,
) -> SceneGraph:  # fmt: skip
    """Move every entity a little in its own frame.

    local' = local exp(w, u): rotation vector w and translation vector u of the screw
    are normal in the tangent space, with the standard deviations ``radians`` and
    ``metres`` per axis; exp is that of the motors (:func:`unisg_blender.poses.exp`), so
    what was rigid stays rigid. Children move along.

    Parameters
    ----------
    upright
        Noise in the plane of the parent only: x, y and yaw, as objects on a level support move.
    fixed
        Categories that stay.
    """
    rng = np.random.default_rng((seed, 11))
    screws = rng.normal(size=(len(graph), 6)) * np.repeat([radians, metres], 3)
    if upright:
        screws[:, [0, 1, 5]] = 0.0
    screws[has_category(graph, fixed)] = 0.0
    motion = exp(screws, "matrix").reshape(-1, 4, 4)
    local = graph.local.copy()
    if upright:
        local[:, :3, :3] = motion[:, :3, :3] @ local[:, :3, :3]
        local[:, :3, 3] += motion[:, :3, 3]
        return graph.replace(local=local)
    size = np.linalg.norm(local[:, :3, :3], axis=1)[:, None]  # metres are metres, however large the entity is scaled
    turn = np.divide(local[:, :3, :3], size, out=np.zeros_like(local[:, :3, :3]), where=size > 0)
    local[:, :3, 3] += np.einsum("nij,nj->ni", turn, motion[:, :3, 3])
    local[:, :3, :3] = local[:, :3, :3] @ motion[:, :3, :3]
    return graph.replace(local=local)


def scale_noise(
    graph: SceneGraph, seed: int, *, factor: float = 0.1, uniform: bool = True, fixed: Collection[str] = FIXED
) -> SceneGraph:
    """Make every entity a little larger or smaller about its origin: local' = local diag(exp(n)), n normal.

    ``factor`` is the standard deviation of the logarithm, per axis unless ``uniform``.
    Children are scaled along with what they stand on.
    """
    rng = np.random.default_rng((seed, 12))
    logs = rng.normal(0.0, factor, (len(graph), 1 if uniform else 3))
    logs[has_category(graph, fixed)] = 0.0
    local = graph.local.copy()
    local[:, :3, :3] *= np.broadcast_to(np.exp(logs), (len(graph), 3))[:, None, :]
    return graph.replace(local=local)


def mesh_jitter(graph: SceneGraph, seed: int, *, metres: float = 0.002) -> SceneGraph:
    """Move the points of every mesh at random, ``metres`` standard deviation per axis.

    Points in the very same place move alike, so that closed meshes stay closed; a
    mesh that many entities share is still stored once. Normals are dropped.
    """
    rng = np.random.default_rng((seed, 13))
    return graph.replace(meshes=tuple(_jittered(mesh, rng, metres) for mesh in graph.meshes))


def _jittered(mesh: Mesh, rng: np.random.Generator, metres: float) -> Mesh:
    places, weld = np.unique(mesh.points, axis=0, return_inverse=True)
    moved = places + rng.normal(0.0, metres, places.shape).astype(np.float32)
    return replace(mesh, points=moved[weld.reshape(-1)], normals=None)


def category_dropout(
    graph: SceneGraph, seed: int, *, probability: float = 0.1, kept: Collection[str] = FIXED
) -> SceneGraph:
    """Leave whole entities out, with all that stands on them: each category with that probability.

    Relations, actions and lessons that speak of what is gone stay: they are then
    about entities that are not in the scene, as in any edited file.

    Raises
    ------
    UniSGError
        If the probability is not between 0 and 1.
    """
    if not 0 <= probability <= 1:
        raise UniSGError(f"a probability lies between 0 and 1, not {probability}")
    rng = np.random.default_rng((seed, 14))
    gone = rng.random(len(graph.vocabulary)) < probability
    gone &= np.array([name not in kept for name in graph.vocabulary], bool)
    dropped = with_rows_below(graph.parent, np.append(gone, False)[graph.category])
    return take(graph, np.flatnonzero(~dropped))


def quarter_turns(graph: SceneGraph, turns: int) -> SceneGraph:
    """The scene turned by ``turns`` x 90 degrees about the world's z axis; exact, no rounding."""
    cos, sin = [(1, 0), (0, 1), (-1, 0), (0, -1)][turns % 4]
    turn = np.eye(4)
    turn[:2, :2] = [[cos, -sin], [sin, cos]]
    return moved_scene(graph, turn)


def mirrored(graph: SceneGraph) -> SceneGraph:
    """The scene in a mirror: the world's x becomes -x, and every entity is mirrored in its own x.

    local' = M local M with M = diag(-1, 1, 1), and the meshes are mirrored: no matrix
    gets a negative scale, and fronts (-y) stay fronts. Reference poses of actions are
    mirrored too. Other components and words ("left knee") stay as they are.
    """
    flip = np.diag([-1.0, 1.0, 1.0, 1.0])
    tables = dict(graph.components)
    if "world" in tables:
        tables["world"] = Table(tables["world"].rows, {"matrix": flip @ tables["world"].columns["matrix"] @ flip})
    tables |= _with_references(graph, lambda action, pose: flip @ pose @ flip + 0.0)
    meshes = tuple(_mirrored_mesh(mesh) for mesh in graph.meshes)
    return graph.replace(local=flip @ graph.local @ flip, meshes=meshes, components=tables)


def _mirrored_mesh(mesh: Mesh) -> Mesh:
    """Points mirrored, and every face walked the other way round so that it still looks outwards."""
    face = np.repeat(np.arange(len(mesh.offsets) - 1), np.diff(mesh.offsets))
    back = mesh.offsets[face] + mesh.offsets[face + 1] - 1 - np.arange(len(mesh.corners))
    flip = np.array([-1, 1, 1], np.float32)
    return replace(
        mesh,
        points=mesh.points * flip,
        corners=mesh.corners[back],
        normals=None if mesh.normals is None else mesh.normals[back] * flip,
        uvs={name: layer[back] for name, layer in mesh.uvs.items()},
    )


def moved_scene(graph: SceneGraph, motion: NDArray[np.float64]) -> SceneGraph:
    """The whole scene moved in the world; reference poses in the world's frame move along."""
    local = graph.local.copy()
    roots = graph.parent < 0
    local[roots] = motion @ local[roots]
    tables = dict(graph.components)
    if "world" in tables:
        tables["world"] = Table(tables["world"].rows, {"matrix": motion @ tables["world"].columns["matrix"]})
    tables |= _with_references(graph, lambda action, pose: pose if action.frame else motion @ pose)
    return graph.replace(local=local, components=tables)


def _with_references(graph: SceneGraph, change: Callable[[ActionData, Matrix], Matrix]) -> dict[str, Table]:
    """The table of actions with changed reference poses; an empty dict where there is none."""
    actions = graph.components.get("actions")
    if actions is None:
        return {}

    def changed(action: ActionData) -> ActionData:
        """The action with its reference pose changed, if it has one."""
        pose = action.reference_matrix
        return action if pose is None else replace(action, reference=tuple(change(action, pose).reshape(-1).tolist()))

    return {"actions": table(actions.rows, data=[*map(changed, actions.columns["data"])])}
