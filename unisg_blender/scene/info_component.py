"""The info component: what stands directly under each entity."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .graph import SceneGraph


def info(graph: SceneGraph) -> NDArray[np.int64]:
    """Count the child nodes of every entity by node type.

    In the UniSG graph an entity's children are its child entities and its own
    components. Source: UniSG^GA, section 3 (info node).

    Returns
    -------
    int64 (N, 4)
        Numbers of (entity, TRS, mesh, ActionData) nodes under each entity.
    """
    count = len(graph)
    counts = np.zeros((count, 4), np.int64)
    counts[:, 0] = np.bincount(graph.parent[graph.parent >= 0], minlength=count)
    counts[:, 1] = 1
    counts[:, 2] = graph.mesh >= 0
    actions = graph.components.get("actions")
    if actions is not None:
        counts[:, 3] = np.bincount(actions.rows, minlength=count)
    return counts
