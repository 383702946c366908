"""Component tables as the writers of new objects go through them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import bpy

from ...scene.graph import SceneGraph

Objects = Mapping[int, bpy.types.Object]


def entries(
    graph: SceneGraph, component: str, objects: Objects
) -> Iterator[tuple[int, bpy.types.Object, dict[str, Any]]]:
    """(row, object, values by column) of every entry of a component whose entity is one of ``objects``, by row."""
    found = graph.components.get(component)
    if found is None:
        return
    for place, row in enumerate(found.rows.tolist()):
        if row in objects:
            yield row, objects[row], {name: column[place] for name, column in found.columns.items()}
