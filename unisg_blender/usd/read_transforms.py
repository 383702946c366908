"""Local matrices of entities, in metres and Z up."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Usd, UsdGeom, Vt

from ..scene import components
from ..scene.graph import Table, table
from ..scene.hierarchy import compose_world
from . import schema
from .traverse import Entities

SEES_ALONG_MINUS_Z = ("CAMERA", "LIGHT")
SINGULAR = 1e-9


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
    local = from_usd(Vt.Matrix4dArray([matrix for matrix, _ in read]))
    parent = np.array(found.parent, np.int64)
    own = np.broadcast_to(frame, (count, 4, 4)).copy()
    size = np.cbrt(np.linalg.det(frame[:3, :3]))
    own[[kind in SEES_ALONG_MINUS_Z for kind in found.kind]] = np.diag([size, size, size, 1.0])
    above = np.concatenate([own, frame[None]])[parent]
    reset = np.array([resets for _, resets in read], bool)
    if not (frame == np.eye(4)).all():
        moved = np.where(reset[:, None, None], frame, above)
        local = moved @ local @ np.linalg.inv(own)
    if not reset.any():
        return Frames(local, own, above)
    return _with_resets(found, local, own, above, parent, reset)


def _with_resets(
    found: Entities, local: NDArray[np.float64], own: NDArray[np.float64], above: NDArray[np.float64],
    parent: NDArray[np.int64], reset: NDArray[np.bool_],
) -> Frames:  # fmt: skip
    """Entities that ignore their parent's transform: a local matrix that leads there, else the component ``world``."""
    rows = np.flatnonzero(reset)
    free = np.where(reset, -1, parent)
    world = compose_world(local, free)
    fixed = []
    for row in rows:
        stored = found.prim[row].GetAttribute(schema.LOCAL)
        base = world[parent[row]] if parent[row] >= 0 else np.eye(4)
        if stored.HasAuthoredValue():
            stored_matrix = from_usd(Vt.Matrix4dArray([Gf.Matrix4d(stored.Get())]))[0]
            local[row] = above[row] @ stored_matrix @ np.linalg.inv(own[row])
            fixed.append(row)
        elif np.linalg.cond(base[:3, :3]) < 1 / SINGULAR:
            local[row] = np.linalg.solve(base, world[row])
        else:
            fixed.append(row)
    tables = {components.WORLD: table(fixed, matrix=world[fixed])} if fixed else {}
    return Frames(local, own, above, tables)


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
    """``matrix4d[]`` as (K, 4, 4) matrices for column vectors."""
    array = np.array(matrices, np.float64).reshape(-1, 4, 4)
    return np.ascontiguousarray(array.transpose(0, 2, 1))
