"""Instanced scenegraphs: point instancers where those are exact, native instances elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Sdf, Vt

from ...scene import components
from ...scene.graph import SceneGraph
from .. import schema
from ..names import Identifiers
from .specs import Types, attribute, custom, define, matrices, points, relationship

FEW = 8
"""Up to so many copies stand as native instances, which every tool can edit one by one."""


def write_instances(prims: Sequence[Any], graph: SceneGraph, prototype_path: Callable[[SceneGraph], Any]) -> None:
    """Author the component ``instances`` under the prims of its entities.

    ``prototype_path`` gives where a prototype stands, and writes it the first time.
    """
    found = graph.components.get(components.INSTANCES)
    for row, entries in () if found is None else found.groups():
        identifiers = Identifiers(child.name for child in prims[row].nameChildren)
        groups: dict[tuple[int, str], list[int]] = {}
        for item, (prototype, source) in enumerate(zip(entries["prototype"], entries["source"], strict=True)):
            groups.setdefault((id(prototype), source), []).append(item)
        for (_, source), items in groups.items():
            prototype = entries["prototype"][items[0]]
            placed = entries["matrix"][items]
            path = prototype_path(prototype)
            if len(items) > FEW and upright(placed):
                _write_point_instancer(prims[row], identifiers.take(prototype.title), path, placed, source)
            else:
                _write_native(prims[row], identifiers, prototype.title, path, placed, source)


def upright(placed: NDArray[np.float64]) -> bool:
    """True if no matrix turns or shears: point instancers keep quaternions in half precision only."""
    linear = placed[:, :3, :3]
    return bool((linear[:, ~np.eye(3, dtype=bool)] == 0).all())


def _write_native(
    parent: Any, identifiers: Identifiers, name: str, path: Any, placed: NDArray[np.float64], source: str
) -> None:
    reference = Sdf.ReferenceListOp.Create(prependedItems=[Sdf.Reference("", path)])
    for matrix in matrices(placed):
        prim = define(parent, identifiers.take(name), "Xform")
        prim.SetInfo("references", reference)
        prim.instanceable = True
        attribute(prim, schema.TRANSFORM, Types.Matrix4d, matrix, uniform=False)
        attribute(prim, "xformOpOrder", Types.TokenArray, [schema.TRANSFORM])
        custom(prim, schema.SOURCE, Types.Token, source)


def _write_point_instancer(parent: Any, identifier: str, path: Any, placed: NDArray[np.float64], source: str) -> None:
    prim = define(parent, identifier, "PointInstancer")
    prototype = define(prim, "prototype", "Xform")
    prototype.SetInfo("references", Sdf.ReferenceListOp.Create(prependedItems=[Sdf.Reference("", path)]))
    relationship(prim, "prototypes", [prototype.path], is_custom=False)
    count = len(placed)
    attribute(prim, "protoIndices", Types.IntArray, Vt.IntArray(count, 0), uniform=False)
    attribute(prim, "positions", Types.Point3fArray, points(placed[:, :3, 3]), uniform=False)
    attribute(prim, "scales", Types.Float3Array, points(np.einsum("nii->ni", placed[:, :3, :3])), uniform=False)
    custom(prim, schema.MATRICES, Types.Matrix4dArray, matrices(placed))
    custom(prim, schema.SOURCE, Types.Token, source)
