"""The component ``instances`` from native instances of ours and from point instancers."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom

from ...errors import UniSGError
from ...scene import components
from ...scene.graph import SceneGraph, Table, table
from .. import schema
from ..names import true_name
from .mesh_topology import array
from .prim_entities import Entities
from .xforms import from_usd, local_transform

if TYPE_CHECKING:
    from .stage_reader import StageReader

SAME = 1e-5
"""Relative difference that single precision leaves between a placement and its exact matrix."""
Entry = tuple[int, SceneGraph, NDArray[np.float64], str]


def read_instances(found: Entities, reader: StageReader) -> dict[str, Table]:
    """The component ``instances``: (entity, prototype, placement, source) for every copy."""
    entries: list[Entry] = []
    for row, prim in found.instances:
        if prim.IsA(UsdGeom.PointInstancer):
            entries += _point_instances(row, prim, reader)
        else:
            placed = _turned(from_usd([local_transform(prim)[0]]), reader)
            source = str(prim.GetAttribute(schema.SOURCE).Get())
            entries.append((row, _prototype(prim, reader, children=True), placed[0], source))
    if not entries:
        return {}
    return {
        components.INSTANCES: table(
            [row for row, _, _, _ in entries],
            prototype=[graph for _, graph, _, _ in entries],
            matrix=np.array([matrix for _, _, matrix, _ in entries]).reshape(-1, 4, 4),
            source=[source for _, _, _, source in entries],
        )
    }


def _turned(placed: NDArray[np.float64], reader: StageReader) -> NDArray[np.float64]:
    return reader.frame @ placed @ np.linalg.inv(reader.frame)


def _prototype(prim: Any, reader: StageReader, *, children: bool) -> SceneGraph:
    """The scenegraph of a prototype prim, the same object for the same prototype.

    ``children``: the prim only holds the prototype's entities, as ours do.
    """
    from .stage_reader import read_graph

    stack = prim.GetPrimStack()
    key = (stack[-1].layer.identifier, stack[-1].path) if children else prim.GetPath()
    if key in reader.reading:
        raise UniSGError(f"{prim.GetPath()}: is a prototype of itself")
    if key not in reader.prototypes:
        reader.reading.add(key)
        name = true_name(prim, stack[-1].name if children else "")
        if children:
            tops = prim.GetFilteredChildren(Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsDefined))
            reader.prototypes[key] = read_graph(tops, reader, name, prim, nested=True)
        else:
            reader.prototypes[key] = read_graph([prim], reader, name, nested=True)
        reader.reading.discard(key)
    return reader.prototypes[key]


def _point_instances(row: int, prim: Any, reader: StageReader) -> list[Entry]:
    instancer = UsdGeom.PointInstancer(prim)
    time = Usd.TimeCode.EarliestTime()
    targets = [prim.GetStage().GetPrimAtPath(path) for path in instancer.GetPrototypesRel().GetForwardedTargets()]
    index = array(instancer.GetProtoIndicesAttr(), np.int64)
    if not all(targets) or (len(index) and (index.min() < 0 or index.max() >= len(targets))):
        warnings.warn(f"{prim.GetPath()}: names prototypes that are not there; left out", stacklevel=2)
        return []
    own = prim.HasAttribute(schema.SOURCE)
    placed = _placements(instancer, time)
    if placed is None or len(placed) != len(index):
        warnings.warn(f"{prim.GetPath()}: its arrays differ in length; left out", stacklevel=2)
        return []
    stored = prim.GetAttribute(schema.MATRICES).Get()
    if stored is not None and len(stored) == len(index):
        exact = from_usd(stored)
        if np.abs(exact - placed).max(initial=0) <= SAME * np.abs(exact).max(initial=0):  # else another tool moved them
            placed = exact
    shown = np.array(instancer.ComputeMaskAtTime(time) or np.ones(len(index), bool), bool)
    placed = _turned(placed, reader)
    source = str(prim.GetAttribute(schema.SOURCE).Get()) if own else "GEOMETRY"
    graphs = {number: _prototype(targets[number], reader, children=own) for number in np.unique(index).tolist()}
    offset = np.eye(4)
    if own:  # the instancer itself is no entity: its frame is the entity's
        offset = _turned(from_usd([local_transform(prim)[0]]), reader)[0]
    return [
        (row, graphs[number], offset @ matrix, source)
        for number, matrix, seen in zip(index.tolist(), placed, shown, strict=True)
        if seen
    ]


def _placements(instancer: Any, time: Any) -> NDArray[np.float64] | None:
    try:
        found = instancer.ComputeInstanceTransformsAtTime(
            time, time, UsdGeom.PointInstancer.ExcludeProtoXform, UsdGeom.PointInstancer.IgnoreMask
        )
    except Exception:  # Tf errors of damaged arrays
        return None
    return from_usd(found)
