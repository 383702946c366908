"""One scenegraph out of several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from .assembly import canonical, index_categories
from .component_table import joined
from .graph import SceneGraph
from .mesh import Material, Mesh


def append(graph: SceneGraph, parts: Sequence[SceneGraph], under: Sequence[str] = ()) -> SceneGraph:
    """A scenegraph with the entities of others besides its own, in canonical order.

    A mesh that several have is stored once; a material whose name stands for another one
    by then gets a new name. Of component tables of one name with different columns those
    of the first count.

    Parameters
    ----------
    parts
        The other scenegraphs. Their uids are new ones.
    under
        For each part the uid of the entity that its roots hang under, of ``graph`` or of any
        part, "" for none; roots stay roots when omitted. Their ``local`` is that in its frame.

    Raises
    ------
    UniSGError
        If a uid is given twice, or the parts hang under each other in a circle.
    KeyError
        If there is no entity with a uid of ``under``.
    """
    if not parts:
        return graph
    whole = [graph, *parts]
    starts = np.cumsum([0, *map(len, whole)]).tolist()
    uid = tuple(uid for part in whole for uid in part.uid)
    row_of = {uid: row for row, uid in enumerate(uid)} | {"": -1}
    above = [-1, *(row_of[uid] for uid in under or [""] * len(parts))]
    parents = [np.where(part.parent < 0, above[at], part.parent + starts[at]) for at, part in enumerate(whole)]
    category, vocabulary = index_categories([part.category_name(row) for part in whole for row in range(len(part))])
    tables = {
        key: joined([(part.components[key], starts[at]) for at, part in enumerate(whole) if key in part.components])
        for key in dict.fromkeys(key for part in whole for key in part.components)
    }
    shelf = _Shelf()
    return canonical(
        graph.replace(
            name=tuple(name for part in whole for name in part.name),
            uid=uid,
            type=np.concatenate([part.type for part in whole]),
            parent=np.concatenate(parents).astype(np.int32),
            category=category,
            vocabulary=vocabulary,
            local=np.concatenate([part.local for part in whole]),
            mesh=np.concatenate([np.array([*shelf.take(part), -1], np.int32)[part.mesh] for part in whole]),
            meshes=tuple(shelf.meshes),
            materials=shelf.materials,
            components=tables,
        )
    ).validate()


class _Shelf:
    """Meshes and materials, each once."""

    def __init__(self) -> None:
        self.meshes: list[Mesh] = []
        self.materials: dict[str, Material] = {}
        self._place: dict[int, int] = {}

    def take(self, part: SceneGraph) -> list[int]:
        """Take in the meshes of a scenegraph and their materials; returns the place of each mesh."""
        new = {name: self._name(material) for name, material in part.materials.items()}
        for mesh in part.meshes:
            if id(mesh) not in self._place:
                self._place[id(mesh)] = len(self.meshes)
                self.meshes.append(_with_materials(mesh, new))
        return [self._place[id(mesh)] for mesh in part.meshes]

    def _name(self, material: Material) -> str:
        """Under which name a material is kept: its own if that is free or stands for the same."""
        name, number = material.name, 0
        while self.materials.setdefault(name, replace(material, name=name)) != replace(material, name=name):
            number += 1
            name = f"{material.name}.{number:03d}"
        return name


def _with_materials(mesh: Mesh, names: Mapping[str, str]) -> Mesh:
    slots = tuple(names.get(name, name) for name in mesh.materials)
    return mesh if slots == mesh.materials else replace(mesh, materials=slots)
