"""The UniSG scenegraph: a structure of arrays with sparse component tables, and its entities as views on the rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError, did_you_mean
from .action_data import ActionData
from .component_table import Table
from .frame_range import FrameRange
from .mesh import Material, Mesh
from .parents import compose_world, subtree_rows

TYPES = (
    "MESH", "EMPTY", "CAMERA", "LIGHT", "ARMATURE", "CURVE", "CURVES", "SURFACE", "META", "FONT", "LATTICE",
    "GREASEPENCIL", "POINTCLOUD", "VOLUME", "SPEAKER", "LIGHT_PROBE", "OTHER",
)  # fmt: skip
"""Object types, as Blender names them; ``SceneGraph.type`` holds positions in this tuple."""

TYPE_INDEX = {name: index for index, name in enumerate(TYPES)}

_COLUMNS: dict[str, tuple[type[np.generic], tuple[int, ...]]] = {
    "type": (np.integer, ()), "parent": (np.integer, ()), "category": (np.integer, ()), "mesh": (np.integer, ()),
    "local": (np.floating, (4, 4)),
}  # fmt: skip
"""Kind of number and shape of one entity's entry, by column."""


@dataclass(frozen=True, eq=False)
class SceneGraph:
    """One scene; N entities, parents before their children. It is never changed: what is derived is computed once.

    Attributes
    ----------
    name, uid
        N strings; a uid is unique in the scene, a name may repeat.
    type
        int8 (N,): position in :data:`TYPES`.
    parent
        int32 (N,): row of the parent, -1 for a root.
    category
        int32 (N,): position in ``vocabulary``, -1 for none.
    vocabulary
        The category names that occur, sorted.
    local
        float64 (N, 4, 4): child-to-parent matrices, column vectors, metres,
        Z up, right-handed (the TRS component).
    mesh
        int32 (N,): position in ``meshes``, -1 for none.
    meshes
        Each mesh once.
    materials
        Materials by name.
    components
        Sparse tables by component name: ``actions`` (column ``data`` of
        :class:`~.action_data.ActionData`), ``lsa`` (column ``data`` of
        :class:`~.lesson_node.LessonNode`), ``relations`` (``kind``, ``target`` uid),
        ``properties`` (``json``: all other custom properties), ``world``
        (``matrix``: the evaluated world matrix of entities that constraints
        move away from ``local``), and others.
    title
        Name of the scene.
    frames
        Its frames; None where nobody said.

    Raises
    ------
    UniSGError
        If a column is not of the length, the shape or the kind that it should be.
    """

    name: tuple[str, ...]
    uid: tuple[str, ...]
    type: NDArray[np.int8]
    parent: NDArray[np.int32]
    category: NDArray[np.int32]
    vocabulary: tuple[str, ...]
    local: NDArray[np.float64]
    mesh: NDArray[np.int32]
    meshes: tuple[Mesh, ...] = ()
    materials: Mapping[str, Material] = field(default_factory=dict)
    components: Mapping[str, Table] = field(default_factory=dict)
    title: str = "Scene"
    frames: FrameRange | None = None

    def __post_init__(self) -> None:
        """Refuse columns that do not belong together; :meth:`validate` looks at what they hold."""
        count = len(self.name)
        if len(self.uid) != count:
            raise UniSGError(f"the column 'uid' has {len(self.uid)} entries for {count} names")
        for key, (kind, shape) in _COLUMNS.items():
            column = np.asanyarray(getattr(self, key))
            if column.shape != (count, *shape) or not issubclass(column.dtype.type, kind):
                wanted = f"{kind.__name__} {(count, *shape)}"
                raise UniSGError(f"the column {key!r} must be {wanted}, not {column.dtype} {column.shape}")

    def validate(self) -> SceneGraph:
        """This scenegraph, if what its columns hold is sound.

        Raises
        ------
        UniSGError
            Naming the column: a uid that is given twice, parents that do not come before their
            children (so also a cycle), a number beyond its vocabulary, meshes or types, a component
            table whose rows are not ascending rows of this scene.
        """
        count = len(self)
        if len(self.row_of_uid) != count:
            twice = next(uid for row, uid in enumerate(self.uid) if self.row_of_uid[uid] != row)
            raise UniSGError(f"the column 'uid' has {twice!r} more than once")
        wrong = np.flatnonzero(self.parent >= np.arange(count))
        if len(wrong):
            row = int(wrong[0])
            raise UniSGError(f"the column 'parent' has {self.parent[row]} in row {row}: parents must come first")
        lengths = {"type": (0, len(TYPES)), "parent": (-1, count), "category": (-1, len(self.vocabulary))}
        for key, (low, stop) in (lengths | {"mesh": (-1, len(self.meshes))}).items():
            column = getattr(self, key)
            if count and not (low <= column.min() and column.max() < stop):
                row = int(np.flatnonzero((column < low) | (column >= stop))[0])
                raise UniSGError(f"the column {key!r} has {column[row]} in row {row}: it goes from {low} to {stop - 1}")
        for key, component in self.components.items():
            rows = component.rows
            if len(rows) and (rows[0] < 0 or rows[-1] >= count or (np.diff(rows) < 0).any()):
                raise UniSGError(f"the component {key!r} must have ascending rows from 0 to {count - 1}")
        return self

    def __len__(self) -> int:
        return len(self.name)

    def __getitem__(self, key: int | str) -> Entity:
        """The entity at a row, or the first one with that name (KeyError if there is none)."""
        return Entity(self, self.row(key) if isinstance(key, str) else range(len(self))[key])

    @cached_property
    def world(self) -> NDArray[np.float64]:
        """World matrices, float64 (N, 4, 4), column vectors, metres; read-only.

        Entities that constraints move have their evaluated matrix, and what hangs
        under them follows.
        """
        local, parent, moved = self.local, self.parent, self.components.get("world")
        if moved is not None:
            local, parent = local.copy(), parent.copy()
            local[moved.rows], parent[moved.rows] = moved.columns["matrix"], -1
        return _frozen(compose_world(local, parent))

    @cached_property
    def info(self) -> NDArray[np.int64]:
        """The info component, int64 (N, 4): how many (entity, TRS, mesh, ActionData) nodes each entity has; read-only.

        In the UniSG graph an entity's children are its child entities and its own
        components. Source: UniSG^GA, section 3 (info node).
        """
        counts = np.ones((len(self), 4), np.int64)
        counts[:, 0] = np.bincount(self.parent[self.parent >= 0], minlength=len(self))
        counts[:, 2] = self.mesh >= 0
        rows = np.array([row for (row,) in self.entries("actions")], np.int64)
        counts[:, 3] = np.bincount(rows, minlength=len(self))
        return _frozen(counts)

    @cached_property
    def row_of_uid(self) -> dict[str, int]:
        """Row of each uid."""
        return {uid: row for row, uid in enumerate(self.uid)}

    def row(self, name: str) -> int:
        """Row of the first entity with that name; KeyError if there is none."""
        try:
            return self.name.index(name)
        except ValueError:
            raise KeyError(f"no entity is named {name!r}{did_you_mean(name, self.name)}") from None

    def category_name(self, row: int) -> str:
        """The category of a row, "" for none."""
        index = self.category[row]
        return self.vocabulary[index] if index >= 0 else ""

    def entries(self, component: str, *columns: str, row: int | None = None) -> list[tuple[Any, ...]]:
        """(row, value in each column) of every entry of a component, or of one row's; empty where there is none."""
        found = self.components.get(component)
        if found is None:
            return []
        start, stop = (0, len(found.rows)) if row is None else np.searchsorted(found.rows, (row, row + 1))
        values = (found.columns[name][start:stop] for name in columns)
        return list(zip(found.rows[start:stop].tolist(), *values, strict=True))

    def replace(self, **changes: Any) -> SceneGraph:
        """A copy with some columns exchanged."""
        return replace(self, **changes)

    def with_component(self, name: str, component: Table) -> SceneGraph:
        """A copy with a component table added, replaced, or (if it is empty) removed."""
        others = {key: value for key, value in self.components.items() if key != name}
        return self.replace(components=others | ({name: component} if len(component.rows) else {}))


def _frozen(array: NDArray[Any]) -> NDArray[Any]:
    array.flags.writeable = False
    return array


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
        return tuple(Entity(self.scene, row) for row in np.flatnonzero(self.scene.parent == self.row).tolist())

    @property
    def descendants(self) -> tuple[Entity, ...]:
        """Everything below this entity."""
        return tuple(Entity(self.scene, row) for row in subtree_rows(self.scene.parent, self.row)[1:].tolist())

    @property
    def local(self) -> NDArray[np.float64]:
        """The TRS component: float64 (4, 4), this frame to the parent's."""
        return self.scene.local[self.row]

    @property
    def world(self) -> NDArray[np.float64]:
        """float64 (4, 4), this frame to the world."""
        return self.scene.world[self.row]

    @property
    def mesh(self) -> Mesh | None:
        """The mesh component."""
        index = int(self.scene.mesh[self.row])
        return self.scene.meshes[index] if index >= 0 else None

    @property
    def info(self) -> NDArray[np.int64]:
        """The info component: counts of (entity, TRS, mesh, ActionData) nodes among the children."""
        return self.scene.info[self.row]

    @property
    def actions(self) -> tuple[ActionData, ...]:
        """The ActionData components that belong to this entity."""
        return tuple(action for _, action in self.scene.entries("actions", "data", row=self.row))

    def component(self, name: str) -> dict[str, NDArray[Any]]:
        """This entity's entries of a component table; an empty dict if there is no such table."""
        found = self.scene.components.get(name)
        return {} if found is None else found.of(self.row)
