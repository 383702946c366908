"""Categories for what has none: by the words of names, and by geometry for what is building."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..scene import SceneGraph
from ..scene.assembly import index_categories
from ..spatial.structure.building_rows import building_rows
from ..words import thing_table, understand


def told_categories(
    graph: SceneGraph, vocabulary: Sequence[str] = (), said: Mapping[str, str] | None = None
) -> SceneGraph:
    """The scene with categories for the things whose names say what they are, and for its floors, walls and ceilings.

    Categories that are there stay, unless a ``vocabulary`` has another word for them; without one, things are called as
    in the table of words. ``said`` is what the user says of words, see :func:`~..words.understand`.
    """
    known = tuple(vocabulary) or tuple(thing_table().things)
    read = understand(graph, known, said).graph
    if not vocabulary:
        read = _with_own(read, graph)
    built = building_rows(read) if (read.category < 0).any() else {}
    names = [read.category_name(row) or built.get(row, "") for row in range(len(read))]
    category, used = index_categories(names)
    return read.replace(category=category, vocabulary=used)


def _with_own(read: SceneGraph, graph: SceneGraph) -> SceneGraph:
    """The scene as it was read, with the categories that its maker gave."""
    names = [graph.category_name(row) or read.category_name(row) for row in range(len(graph))]
    category, used = index_categories(names)
    return read.replace(category=category, vocabulary=used)
