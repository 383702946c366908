"""Joints as a component: how an entity can move against its parent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...scene import SceneGraph, table
from ...scene.components import JOINTS


@dataclass(frozen=True)
class Joint:
    """A row of the component ``joints`` before rows are known; ``uid`` is that of the entity that moves."""

    uid: str
    name: str
    kind: str
    axis: tuple[float, float, float]
    anchor: tuple[float, float, float]
    low: float
    high: float


def with_joints(graph: SceneGraph, joints: Sequence[Joint]) -> SceneGraph:
    """The scene with its joints; fixed ones are none."""
    rows = graph.row_of_uid
    kept = sorted(
        (each for each in joints if each.kind != "fixed" and each.uid in rows), key=lambda each: rows[each.uid]
    )
    found = table(
        [rows[each.uid] for each in kept],
        name=[each.name for each in kept],
        kind=[each.kind for each in kept],
        axis=np.array([each.axis for each in kept], np.float64).reshape(-1, 3),
        anchor=np.array([each.anchor for each in kept], np.float64).reshape(-1, 3),
        low=np.array([each.low for each in kept], np.float64),
        high=np.array([each.high for each in kept], np.float64),
    )
    return graph.with_component(JOINTS, found)
