"""Entities: light views on the rows of a scenegraph."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .graph import TYPES, SceneGraph
from .hierarchy import children, subtree, world_matrices
from .info_component import info

if TYPE_CHECKING:
    from .action_data import ActionData
    from .mesh import Mesh


@dataclass(frozen=True)
class Entity:
    """One row of a scenegraph, as an object: ``scene["Scalpel"].parent.children``."""

    scene: SceneGraph = field(repr=False)
    row: int

    @property
    def name(self) -> str:
        """Name, which other entities may share."""
        return self.scene.name[self.row]

    @property
    def uid(self) -> str:
        """Unique identifier."""
        return self.scene.uid[self.row]

    @property
    def type(self) -> str:
        """Object type as Blender names it ("MESH", "EMPTY" ...)."""
        return TYPES[self.scene.type[self.row]]

    @property
    def category(self) -> str:
        """What the object is, "" if that is not known."""
        return self.scene.category_name(self.row)

    @property
    def parent(self) -> Entity | None:
        """The parent, None for a root."""
        row = int(self.scene.parent[self.row])
        return Entity(self.scene, row) if row >= 0 else None

    @property
    def children(self) -> tuple[Entity, ...]:
        """Direct children in entity order."""
        return tuple(Entity(self.scene, int(row)) for row in children(self.scene, self.row))

    @property
    def descendants(self) -> tuple[Entity, ...]:
        """Everything below this entity."""
        return tuple(Entity(self.scene, int(row)) for row in subtree(self.scene, self.row) if row != self.row)

    @property
    def local(self) -> NDArray[np.float64]:
        """The TRS component: float64 (4, 4), this frame to the parent's."""
        return self.scene.local[self.row]

    @property
    def world(self) -> NDArray[np.float64]:
        """float64 (4, 4), this frame to the world."""
        return world_matrices(self.scene)[self.row]

    @property
    def mesh(self) -> Mesh | None:
        """The mesh component."""
        index = int(self.scene.mesh[self.row])
        return self.scene.meshes[index] if index >= 0 else None

    @property
    def info(self) -> NDArray[np.int64]:
        """The info component: counts of (entity, TRS, mesh, ActionData) nodes among the children."""
        return info(self.scene)[self.row]

    @property
    def actions(self) -> tuple[ActionData, ...]:
        """The ActionData components that belong to this entity."""
        found = self.component("actions").get("data")
        return () if found is None else tuple(found)

    def component(self, name: str) -> dict[str, NDArray[Any]]:
        """This entity's entries of a component table; an empty dict if there is no such table."""
        found = self.scene.components.get(name)
        return {} if found is None else found.of(self.row)
