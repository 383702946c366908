"""The component ``instances`` from native instances of ours and from point instancers."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom

from ...scene import components
from ...scene.component_table import Table, table
from ...scene.graph import SceneGraph
from .. import schema
from .entity_selection import Entities
from .mesh_topology import array
from .xforms import from_usd, local_transform

SAME = 1e-5
"""Relative difference that single precision leaves between a placement and its exact matrix."""
Entry = tuple[int, SceneGraph, NDArray[np.float64], str]
Prototype = Callable[[Any, bool], SceneGraph]
"""The scenegraph of a prototype prim; True: the prim only holds the prototype's entities, as ours do."""


def read_instances(found: Entities, frame: NDArray[np.float64], prototype: Prototype) -> dict[str, Table]:
    """The component ``instances``: (entity, prototype, placement, source) for every copy.

    ``frame`` (4, 4) leads from the stage's frame to metres and Z up; ``prototype`` gives the same
    scenegraph for the same prototype.
    """
    entries: list[Entry] = []
    for row, prim in found.instances:
        if prim.IsA(UsdGeom.PointInstancer):
            entries += _point_instances(row, prim, frame, prototype)
        else:
            placed = _turned(from_usd([local_transform(prim)[0]]), frame)
            source = str(prim.GetAttribute(schema.SOURCE).Get())
            entries.append((row, prototype(prim, True), placed[0], source))
    if not entries:
        return {}
    rows, prototypes, matrices, sources = zip(*entries, strict=True)
    return {components.INSTANCES: table(rows, prototype=prototypes, matrix=np.array(matrices), source=sources)}


def _turned(placed: NDArray[np.float64], frame: NDArray[np.float64]) -> NDArray[np.float64]:
    return frame @ placed @ np.linalg.inv(frame)


def _point_instances(row: int, prim: Any, frame: NDArray[np.float64], prototype: Prototype) -> list[Entry]:
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
    placed = _turned(placed, frame)
    source = str(prim.GetAttribute(schema.SOURCE).Get()) if own else "GEOMETRY"
    graphs = {number: prototype(targets[number], own) for number in np.unique(index).tolist()}
    offset = np.eye(4)
    if own:  # the instancer itself is no entity: its frame is the entity's
        offset = _turned(from_usd([local_transform(prim)[0]]), frame)[0]
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
