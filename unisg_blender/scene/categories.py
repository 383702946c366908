"""Which categories are the building, and which rows are of some categories."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from .graph import SceneGraph

FLOOR = "Floor"

STRUCTURE = (FLOOR, "Wall", "Ceiling", "Door", "Window", "Column", "Stairs")
"""Categories that make the building; everything else stands or hangs in it.

They are never settled or moved, they are no objects to be counted, and a room's shell consists of them. What hangs
from the building, such as a ceiling rail, is not of it.
"""


def has_category(graph: SceneGraph, names: Collection[str]) -> NDArray[np.bool_]:
    """Which rows are of one of these categories, bool (N,)."""
    return np.array([name in names for name in graph.vocabulary] + [False], bool)[graph.category]
