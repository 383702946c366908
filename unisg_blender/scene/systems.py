"""Systems: what is done to the components of a scene, or of a part of it.

A system is any callable ``system(graph, rows)`` that looks at the given rows and
returns its result: columns in, columns out. :func:`run` gives it the rows.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from .graph import SceneGraph
from .hierarchy import subtree, world_matrices

Result = TypeVar("Result")
System = Callable[[SceneGraph, NDArray[np.int64]], Result]


def run(system: System[Result], graph: SceneGraph, root: int | None = None) -> Result:
    """Run a system over the whole scene, or over the subtree under ``root`` (a row)."""
    rows = np.arange(len(graph)) if root is None else subtree(graph, root)
    return system(graph, rows)


def transform_system(graph: SceneGraph, rows: NDArray[np.int64]) -> NDArray[np.float64]:
    """World matrices of the rows, float64 (K, 4, 4)."""
    return world_matrices(graph)[rows]


def category_system(graph: SceneGraph, rows: NDArray[np.int64]) -> dict[str, int]:
    """How many entities of each category are among the rows; "" counts those without one."""
    found, counts = np.unique(graph.category[rows], return_counts=True)
    names = ("", *graph.vocabulary)
    return {names[index + 1]: int(count) for index, count in zip(found, counts, strict=True)}
