"""Local matrices of entities, in metres and Z up."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Usd, UsdGeom, Vt

from ...scene import components
from ...scene.component_table import Table, table
from ...scene.parents import compose_world, reachable
from .. import schema
from .entity_selection import Entities

SEES_ALONG_MINUS_Z = ("CAMERA", "LIGHT")
FLAT = 1e9
AFFINE = np.array([0.0, 0.0, 0.0, 1.0])
"""The last row of the matrices that a scenegraph holds."""

MOVED = 1e-5
"""Relative difference of world matrices from which on an entity counts as moved by another tool."""


@dataclass(frozen=True, eq=False)
class Frames:
    """Where entities stand.

    ``local`` float64 (N, 4, 4) in metres and Z up; ``own`` float64 (N, 4, 4): what
    turns coordinates in each prim's frame into the entity's frame; ``above`` the
    same for the frame of its parent; ``tables`` holds the component ``world``.
    """

    local: NDArray[np.float64]
    own: NDArray[np.float64]
    above: NDArray[np.float64]
    tables: dict[str, Table] = field(default_factory=dict)

    def turned(self, row: int, matrices: NDArray[np.float64]) -> NDArray[np.float64]:
        """Local matrices (T, 4, 4) of a prim as those of its entity."""
        return self.above[row] @ matrices @ np.linalg.inv(self.own[row])


def read_transforms(found: Entities, frame: NDArray[np.float64]) -> Frames:
    """Read the transforms of all entities, at the default time or at the first sample.

    The whole scene is turned into metres and Z up, geometry included, so that no
    entity carries the stage's scale; cameras and lights keep looking along -Z.
    """
    count = len(found.prim)
    read = [local_transform(prim) for prim in found.prim]
    local = from_usd([matrix for matrix, _ in read])
    for row in np.flatnonzero((local[:, 3] != AFFINE).any(axis=1)).tolist():
        warnings.warn(f"{found.prim[row].GetPath()}: its transform is projective; read as affine", stacklevel=2)
        local[row, 3] = AFFINE
    parent, reset = np.array(found.parent, np.int64), np.array([resets for _, resets in read], bool)
    local, lost = reachable(local, np.where(reset, -1, parent))
    for row in lost.tolist():
        warnings.warn(f"{found.prim[row].GetPath()}: its transform is no finite matrix; left out", stacklevel=2)
    own = np.broadcast_to(frame, (count, 4, 4)).copy()
    size = np.cbrt(np.linalg.det(frame[:3, :3]))
    own[[kind in SEES_ALONG_MINUS_Z for kind in found.kind]] = np.diag([size, size, size, 1.0])
    above = np.concatenate([own, frame[None]])[parent]
    if not (frame == np.eye(4)).all():
        moved = np.where(reset[:, None, None], frame, above)
        local = moved @ local @ np.linalg.inv(own)
    local[reset] = _below_parents(local, parent, reset)
    return _with_moved(found, Frames(local, own, above), frame)


def _below_parents(
    local: NDArray[np.float64], parent: NDArray[np.int64], reset: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Local matrices that lead entities which ignore their parent's transform to where they are."""
    rows = np.flatnonzero(reset)
    if not len(rows):
        return local[rows]
    world = np.concatenate([compose_world(local, np.where(reset, -1, parent)), np.eye(4)[None]])
    above = world[parent[rows]]
    flat = ~(np.linalg.cond(above[:, :3, :3]) < FLAT)
    above[flat] = np.eye(4)
    return np.linalg.solve(above, world[rows])


def _with_moved(found: Entities, frames: Frames, frame: NDArray[np.float64]) -> Frames:
    """Put back what the master file says of entities that stand elsewhere than their local matrix says.

    Not of those that another tool has moved since: they stand where their transforms say.
    """
    rows = np.flatnonzero([prim.HasAttribute(schema.WORLD) for prim in found.prim])
    if not len(rows):
        return frames
    stored = from_usd([_matrix(found.prim[row], schema.LOCAL) for row in rows])
    back = np.linalg.inv(frames.own[rows])
    world = frame @ from_usd([_matrix(found.prim[row], schema.WORLD) for row in rows]) @ back
    parent = np.array(found.parent, np.int64)
    shown = np.concatenate([compose_world(frames.local, parent), np.eye(4)[None]])
    flat = ~(np.linalg.cond(shown[parent[rows], :3, :3]) < FLAT)
    gap, size = np.abs(shown[rows] - world).max(axis=(1, 2)), np.abs(world).max(axis=(1, 2))
    kept = flat | (gap <= MOVED * size)
    frames.local[rows[kept]] = (frames.above[rows] @ stored @ back)[kept]
    if not kept.any():
        return frames
    return replace(frames, tables={components.WORLD: table(rows[kept], matrix=world[kept])})


def _matrix(prim: Any, name: str) -> Any:
    value = prim.GetAttribute(name).Get()
    return value if isinstance(value, Gf.Matrix4d) else Gf.Matrix4d(1.0)


def local_transform(prim: Any) -> tuple[Any, bool]:
    """A prim's local matrix as USD has it, and whether it ignores its parent's."""
    form = UsdGeom.Xformable(prim)
    if not form:
        return Gf.Matrix4d(1.0), False
    matrix = form.GetLocalTransformation(read_time(form))
    return matrix, form.GetResetXformStack()


def read_time(form: Any) -> Any:
    """The default time, or the first sample if the transform has samples only."""
    now = Usd.TimeCode.Default()
    if form.TransformMightBeTimeVarying() and any(step.Get(now) is None for step in form.GetOrderedXformOps()):
        return Usd.TimeCode.EarliestTime()
    return now


def from_usd(matrices: Any) -> NDArray[np.float64]:
    """``matrix4d[]``, or a list of ``matrix4d``, as (K, 4, 4) matrices for column vectors."""
    array = np.array(Vt.Matrix4dArray(matrices), np.float64).reshape(-1, 4, 4)
    return np.ascontiguousarray(array.transpose(0, 2, 1))
