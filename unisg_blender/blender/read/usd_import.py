"""What Blender's own USD importer makes of a master file.

Attributes ``unisg:...`` become custom properties of that name, the scene's prim
becomes an empty, and an entity with children an empty with its mesh below it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...errors import UniSGError
from ...runtime.json_records import parse_json
from ...scene.component_table import table
from ...scene.graph import SceneGraph
from ...scene.hierarchy import take
from ...scene.properties import NAMES
from ..helper_objects import HELPER, TYPE

PREFIX, VERSION, PROPERTIES = "unisg:", "unisg:version", "unisg:properties"
IMPORTED = "unisg_imported"
"""Component that marks the rows of objects that Blender's importer made of entities."""
STORED = {name.replace("_", ":", 1): name for name in (*NAMES, TYPE)}


def is_imported(values: Mapping[str, Any]) -> bool:
    """Whether an object with these custom properties is an entity that Blender's importer made."""
    return any(name in values for name in STORED)


def as_written(values: Mapping[str, Any]) -> dict[str, Any]:
    """Custom properties under the names that our own writing gives them; what is derived is left out."""
    found = {name: value for name, value in values.items() if not name.startswith(PREFIX)}
    if PROPERTIES in values:
        try:
            found = dict(parse_json(values[PROPERTIES], PROPERTIES)) | found
        except (UniSGError, TypeError, ValueError, AttributeError):
            found[PROPERTIES] = values[PROPERTIES]
    if VERSION in values:
        found[HELPER] = 1
    return {STORED[name]: value for name, value in values.items() if name in STORED} | found


def join_shapes(graph: SceneGraph) -> SceneGraph:
    """The scenegraph with the meshes that the importer hung below their entities back on those."""
    marked = graph.components.get(IMPORTED)
    if marked is None:
        return graph
    graph = graph.with_component(IMPORTED, table([]))
    imported = np.zeros(len(graph), bool)
    imported[marked.rows] = True
    parents = set(graph.parent.tolist())
    mesh, kind, dropped = graph.mesh.copy(), graph.type.copy(), np.zeros(len(graph), bool)
    name = list(graph.name)
    for row in np.flatnonzero((graph.mesh >= 0) & (graph.parent >= 0) & ~imported).tolist():
        above = int(graph.parent[row])
        plain = row not in parents and np.array_equal(graph.local[row], np.eye(4))
        if plain and imported[above] and mesh[above] < 0:
            mesh[above], kind[above], dropped[row] = mesh[row], kind[row], True
            name[above] = name[row] if name[above].startswith(f"{name[row]}.") else name[above]
    return take(graph.replace(name=tuple(name), mesh=mesh, type=kind), np.flatnonzero(~dropped))
