"""What is the building and what is an object, and which entities belong to one object."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..scene import SceneGraph

STRUCTURE = ("Floor", "Wall", "Ceiling", "Door", "Window", "Column", "Stairs")
"""Categories that make the shell of a room; what else stands in it is furniture."""


def owners(graph: SceneGraph, also: int = -1) -> NDArray[np.int64]:
    """int64 (N,): row of the categorised entity (or of ``also``) that each entity is or belongs to, -1 for none."""
    found = np.where(graph.category >= 0, np.arange(len(graph)), -1)
    if also >= 0:
        found[also] = also
    for row in np.flatnonzero((found < 0) & (graph.parent >= 0)):  # parents come first
        found[row] = found[graph.parent[row]]
    return found
