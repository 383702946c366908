"""Marks that writing leaves so that reading gives back what was written.

:data:`TYPE` on a mesh says that its entity was a text, a curve or the like.
:data:`HELPER` is on empties that stand for what a scenegraph says without an entity.

A root with shear hangs under a helper (only objects with a parent can have
shear); every instance beyond a plain collection instance has a helper that
carries it. Reading folds them away again.
"""

from __future__ import annotations

import bpy
import numpy as np

from ..scene.component_table import Table, table
from ..scene.components import INSTANCES
from ..scene.graph import SceneGraph
from ..scene.hierarchy import take

HELPER = "unisg_helper"
TYPE = "unisg_type"


def new_helper(name: str, above: bpy.types.Object | None = None) -> bpy.types.Object:
    """An empty that reading folds away."""
    helper = bpy.data.objects.new(name, None)
    helper[HELPER] = 1
    helper.empty_display_size = 0.1
    helper.parent = above
    return helper


def fold(graph: SceneGraph) -> SceneGraph:
    """The scenegraph without its helpers: their instances go to their parents, their children stay in place.

    The component ``unisg_helper`` says which rows these are.
    """
    helpers = graph.components.get(HELPER)
    if helpers is None:
        return graph
    rows = np.zeros(len(graph), bool)
    rows[helpers.rows] = True
    graph = graph.with_component(HELPER, table([]))
    found = graph.components.get(INSTANCES)
    if found is not None:
        carried = rows[found.rows] & (graph.parent[found.rows] >= 0)
        columns = dict(found.columns)
        lifted = graph.local[found.rows] @ columns["matrix"]
        columns["matrix"] = np.where(carried[:, None, None], lifted, columns["matrix"])
        owner = np.where(carried, graph.parent[found.rows], found.rows).astype(np.int32)
        order = np.argsort(owner, kind="stable")
        folded = Table(owner[order], {name: column[order] for name, column in columns.items()})
        graph = graph.with_component(INSTANCES, folded)
    return take(graph, np.flatnonzero(~rows))
