"""Build a scenegraph one entity at a time, for code that makes scenes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import UniSGError
from .action_data import ActionData
from .assembly import Columns, assemble
from .graph import SceneGraph
from .lesson_node import LessonNode
from .mesh import Material, Mesh
from .properties import ObjectProperties
from .relation import Relation


@dataclass
class SceneBuilder:
    """Collects entities; :meth:`build` makes the scenegraph."""

    title: str = "Scene"
    materials: dict[str, Material] = field(default_factory=dict)
    _names: list[str] = field(default_factory=list)
    _types: list[str] = field(default_factory=list)
    _parents: list[int] = field(default_factory=list)
    _locals: list[NDArray[np.float64]] = field(default_factory=list)
    _meshes: list[int] = field(default_factory=list)
    _mesh_table: dict[int, tuple[int, Mesh]] = field(default_factory=dict)
    _properties: list[ObjectProperties] = field(default_factory=list)

    def add(
        self,
        name: str,
        *,
        uid: str,
        parent: int = -1,
        local: ArrayLike | None = None,
        mesh: Mesh | None = None,
        category: str = "",
        kind: str = "",
        actions: tuple[ActionData, ...] = (),
        relations: tuple[Relation, ...] = (),
        lsa: LessonNode | None = None,
        others: Mapping[str, Any] | None = None,
    ) -> int:
        """Add an entity and return its number, to be given as ``parent`` of others.

        ``local`` is the 4x4 child-to-parent matrix in metres, or a place (3,)
        of a thing that is not turned (identity when omitted); the same ``mesh`` object
        given twice is stored once; ``kind`` is the object type, by default "MESH" with
        a mesh and "EMPTY" without; ``others`` are further custom properties, of values
        that JSON can hold.

        Raises
        ------
        UniSGError
            If ``local`` has another shape.
        """
        matrix = np.eye(4) if local is None else np.array(local, np.float64)
        if matrix.shape == (3,):
            place, matrix = matrix, np.eye(4)
            matrix[:3, 3] = place
        if matrix.shape != (4, 4):
            raise UniSGError(f"the local matrix of {name!r} must have the shape (4, 4), not {matrix.shape}")
        self._names.append(name)
        self._types.append(kind or ("MESH" if mesh is not None else "EMPTY"))
        self._parents.append(parent)
        self._locals.append(matrix)
        if mesh is not None:
            self._mesh_table.setdefault(id(mesh), (len(self._mesh_table), mesh))
        self._meshes.append(-1 if mesh is None else self._mesh_table[id(mesh)][0])
        self._properties.append(ObjectProperties(category, uid, actions, relations, lsa, others=others or {}))
        return len(self._names) - 1

    def build(self) -> SceneGraph:
        """The scenegraph, in canonical order."""
        return assemble(
            Columns(
                name=self._names,
                type=self._types,
                parent=np.array(self._parents, np.int32),
                local=np.array(self._locals).reshape(-1, 4, 4),
                mesh=np.array(self._meshes, np.int32),
                meshes=[mesh for _, mesh in self._mesh_table.values()],
                properties=self._properties,
                materials=self.materials,
                title=self.title,
            )
        )
