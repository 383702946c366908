"""From plain records in any order to a scenegraph in canonical order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .component_table import Table
from .copied_behaviour import retarget_properties
from .graph import TYPE_INDEX, SceneGraph
from .hierarchy import take
from .identity import resolve_uids
from .mesh import Material, Mesh
from .order import canonical_order
from .parents import compose_world
from .properties import ObjectProperties, property_tables


@dataclass(frozen=True)
class Columns:
    """The columns of a scene as a reader found them, in any order.

    ``type`` holds names out of :data:`~.graph.TYPES` (others read as "OTHER"),
    ``parent`` positions in these columns (-1 for roots), ``local`` float64
    (N, 4, 4), ``mesh`` positions in ``meshes`` (-1 for none), ``properties`` the
    decoded custom properties, ``components`` further tables by row.
    """

    name: Sequence[str]
    type: Sequence[str]
    parent: NDArray[np.integer]
    local: NDArray[np.float64]
    mesh: NDArray[np.integer]
    meshes: Sequence[Mesh] = ()
    properties: Sequence[ObjectProperties] = ()
    materials: Mapping[str, Material] = field(default_factory=dict)
    components: Mapping[str, Table] = field(default_factory=dict)
    title: str = "Scene"


def assemble(columns: Columns) -> SceneGraph:
    """A scenegraph in canonical order, with unique uids and a sorted vocabulary.

    Raises
    ------
    UniSGError
        If the parents form a cycle, or a column is not sound: see :meth:`~.graph.SceneGraph.validate`.
    """
    names = tuple(columns.name)
    properties = list(columns.properties) or [ObjectProperties()] * len(names)
    stored = [record.uid for record in properties]
    uids = resolve_uids(stored, names)
    parent = np.asarray(columns.parent, np.int32).reshape(len(names))
    local = np.asarray(columns.local, np.float64).reshape(-1, 4, 4)
    properties = retarget_properties(stored, uids, names, properties, lambda: compose_world(local, parent))
    category, vocabulary = index_categories([record.category for record in properties])
    other = TYPE_INDEX["OTHER"]
    graph = SceneGraph(
        name=names,
        uid=tuple(uids),
        type=np.array([TYPE_INDEX.get(kind, other) for kind in columns.type], np.int8),
        parent=parent,
        category=category,
        vocabulary=vocabulary,
        local=local,
        mesh=np.asarray(columns.mesh, np.int32).reshape(len(names)),
        meshes=tuple(columns.meshes),
        materials=dict(columns.materials),
        components={**columns.components, **property_tables(properties)},
        title=columns.title,
    )
    return canonical(graph).validate()


def canonical(graph: SceneGraph) -> SceneGraph:
    """The same scenegraph with its entities in canonical order."""
    order = canonical_order(graph.name, graph.parent)
    return graph if (order == np.arange(len(graph))).all() else take(graph, order)


def index_categories(names: Sequence[str]) -> tuple[NDArray[np.int32], tuple[str, ...]]:
    """Category column and sorted vocabulary from one name per row ("" for none)."""
    vocabulary = tuple(sorted(set(names) - {""}))
    place = {name: index for index, name in enumerate(vocabulary)} | {"": -1}
    return np.array([place[name] for name in names], np.int32).reshape(len(names)), vocabulary
