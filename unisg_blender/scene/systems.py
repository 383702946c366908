"""Systems: what goes over the entities of a scene, or of a part of it, and changes their components.

Entities, components and systems are the three parts of the scenegraph. A system is any callable
that is given a scenegraph and some of its rows, and gives the scenegraph back with components of
these rows replaced; ``docs/systems.md`` shows how to write one.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .graph import SceneGraph
from .hierarchy import subtree


class System(Protocol):
    """Reads components of some rows, and replaces components of them."""

    def __call__(self, graph: SceneGraph, rows: NDArray[np.int64], /) -> SceneGraph:
        """The scenegraph afterwards; ``rows`` int64 (K,) are ascending."""
        ...


def run(graph: SceneGraph, *systems: System, root: int | None = None) -> SceneGraph:
    """The scenegraph after one system after the other.

    Parameters
    ----------
    root
        Run over the subtree under this row; over the whole scene when omitted. Each system is
        given the rows that the subtree then has, whatever the one before added or left out.

    Raises
    ------
    KeyError
        If a system left out the root itself.
    """
    top = None if root is None else graph.uid[root]
    for system in systems:
        rows = np.arange(len(graph)) if top is None else subtree(graph, graph.row_of_uid[top])
        graph = system(graph, rows)
    return graph
