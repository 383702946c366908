"""Which categories are the building, and of which category rows are."""

from __future__ import annotations

from collections.abc import Collection, Sequence

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


def category_numbers(graph: SceneGraph, vocabulary: Sequence[str]) -> NDArray[np.int64]:
    """Category of each row as a position in another vocabulary, int64 (N,), -1 for none and for others."""
    known = {name: position for position, name in enumerate(vocabulary)}
    return np.array([known.get(name, -1) for name in graph.vocabulary] + [-1], np.int64)[graph.category]
