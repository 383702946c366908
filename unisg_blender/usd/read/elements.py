"""Scenes of the Elements framework: untyped prims whose components are child prims ``TRS``, ``Mesh``, ``VA``.

Elements stores matrices for column vectors as they are, without USD's
transposition, in metres with Y up, and triangles without shared points.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Usd

from ...scene.assembly import Columns, assemble
from ...scene.graph import SceneGraph
from ...scene.mesh import Mesh
from ...scene.properties import ObjectProperties
from .entity_attributes import read_entries
from .entity_selection import Entities
from .mesh_topology import array
from .stage import Y_TO_Z

COMPONENTS = ("TRS", "Mesh", "VA")


def is_elements(stage: Any) -> bool:
    """True if untyped prims hold their transforms in children named ``TRS``."""
    if stage.GetDefaultPrim():
        return False
    for prim in stage.Traverse():
        if prim.GetTypeName():
            return False
        if prim.GetName() == "TRS" and prim.HasAttribute("trs"):
            return True
    return False


def read_elements(stage: Any, title: str) -> SceneGraph:
    """The scenegraph of an Elements scene; the prim above all entities is kept as their root."""
    found = Entities()
    rows: dict[Any, int] = {}
    local: list[NDArray[np.float64]] = []
    meshes: list[Mesh] = []
    mesh: list[int] = []
    walk = iter(Usd.PrimRange(stage.GetPseudoRoot()))
    for prim in walk:
        if prim.IsPseudoRoot():
            continue
        if prim.GetName() in COMPONENTS:
            walk.PruneChildren()
            continue
        above = rows.get(prim.GetPath().GetParentPath(), -1)
        rows[prim.GetPath()] = len(found.prim)
        geometry = _read_mesh(prim)
        found.prim.append(prim)
        found.parent.append(above)
        found.kind.append("EMPTY" if geometry is None else "MESH")
        mesh.append(-1 if geometry is None else len(meshes))
        meshes += [] if geometry is None else [geometry]
        local.append(_transform(prim))
    found.shape = [None] * len(found.prim)
    entries = read_entries(found)
    frame = np.array(local).reshape(-1, 4, 4)
    return assemble(
        Columns(
            name=[entry.name for entry in entries],
            type=found.kind,
            parent=np.array(found.parent, np.int32),
            local=Y_TO_Z @ frame @ Y_TO_Z.T,
            mesh=np.array(mesh, np.int32),
            meshes=meshes,
            properties=[_without_links(entry.stored) for entry in entries],
            title=title,
        )
    )


def _without_links(stored: ObjectProperties) -> ObjectProperties:
    """Custom properties without Elements' own name of the parent and its running number."""
    return replace(stored, others={key: value for key, value in stored.others.items() if key not in ("Parent", "ID")})


def _transform(prim: Any) -> NDArray[np.float64]:
    value = prim.GetChild("TRS").GetAttribute("trs").Get() if prim.GetChild("TRS") else None
    return np.eye(4) if value is None else np.array(value, np.float64).reshape(4, 4)


def _read_mesh(prim: Any) -> Mesh | None:
    """Triangles of the component ``Mesh``, or of ``VA`` where only that has points; None without geometry."""
    for name in ("Mesh", "VA"):
        part = prim.GetChild(name)
        points = array(part.GetAttribute("points"), np.float64, 3) if part else np.zeros((0, 3))
        if len(points):
            break
    else:
        return None
    corners = array(part.GetAttribute("indices"), np.int32)
    corners = corners[: len(corners) // 3 * 3]
    primitive = part.GetAttribute("primitive").Get()
    if (primitive not in (None, 4)) or (len(corners) and (corners.min() < 0 or corners.max() >= len(points))):
        corners = corners[:0]  # not triangles, or damaged: the points stay
    turned = (points @ Y_TO_Z[:3, :3].T).astype(np.float32)
    return Mesh(prim.GetName(), turned, corners, np.arange(0, len(corners) + 1, 3, dtype=np.int32))
