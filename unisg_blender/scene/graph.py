"""The UniSG scenegraph: a structure of arrays with sparse component tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .mesh import Material, Mesh

if TYPE_CHECKING:
    from .entity import Entity

TYPES = (
    "MESH", "EMPTY", "CAMERA", "LIGHT", "ARMATURE", "CURVE", "CURVES", "SURFACE", "META", "FONT", "LATTICE",
    "GREASEPENCIL", "POINTCLOUD", "VOLUME", "SPEAKER", "LIGHT_PROBE", "OTHER",
)  # fmt: skip
"""Object types, as Blender names them; ``SceneGraph.type`` holds positions in this tuple."""

TYPE_INDEX = {name: index for index, name in enumerate(TYPES)}


@dataclass(frozen=True, eq=False)
class Table:
    """A sparse component: some rows of the scenegraph have values, most have none.

    ``rows`` is int32 (K,) in ascending order and may repeat (an entity with two
    actions has two rows). Every column has length K along its first axis.
    References to other entities are uids, never row numbers, so that rows can be
    reordered and removed freely.
    """

    rows: NDArray[np.int32]
    columns: Mapping[str, NDArray[Any]]

    def of(self, row: int) -> dict[str, NDArray[Any]]:
        """The values of one row: every column cut to the entries of ``row``."""
        start, stop = np.searchsorted(self.rows, (row, row + 1))
        return {name: column[start:stop] for name, column in self.columns.items()}

    def groups(self) -> Iterator[tuple[int, dict[str, NDArray[Any]]]]:
        """Every row that has values, once, with what :meth:`of` gives for it."""
        rows, starts = np.unique(self.rows, return_index=True)
        for row, start, stop in zip(
            rows.tolist(), starts.tolist(), [*starts[1:].tolist(), len(self.rows)], strict=True
        ):
            yield row, {name: column[start:stop] for name, column in self.columns.items()}

    def take(self, rows: NDArray[np.integer], count: int) -> Table:
        """The table after the scenegraph kept ``rows`` (of ``count``) in that order."""
        place = np.full(count, -1, np.int64)
        place[rows] = np.arange(len(rows))
        moved = place[self.rows]
        order = np.argsort(moved, kind="stable")
        order = order[moved[order] >= 0]
        return Table(moved[order].astype(np.int32), {name: column[order] for name, column in self.columns.items()})


def table(rows: Sequence[int] | NDArray[np.integer], **columns: Sequence[Any] | NDArray[Any]) -> Table:
    """A table from rows in any order and columns; lists become object arrays."""
    order = np.argsort(np.asarray(rows, np.int64), kind="stable")
    arrays = {name: _column(values)[order] for name, values in columns.items()}
    return Table(np.asarray(rows, np.int32)[order], arrays)


def _column(values: Sequence[Any] | NDArray[Any]) -> NDArray[Any]:
    if isinstance(values, np.ndarray):
        return values
    column = np.empty(len(values), object)
    for place, value in enumerate(values):  # one by one: numpy would unpack tuples and arrays of equal length
        column[place] = value
    return column


@dataclass(frozen=True, eq=False)
class SceneGraph:
    """One scene; N entities, parents before their children.

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

    def __len__(self) -> int:
        return len(self.name)

    def __getitem__(self, key: int | str) -> Entity:
        """The entity at a row, or the first one with that name (KeyError if there is none)."""
        from .entity import Entity

        return Entity(self, self.row(key) if isinstance(key, str) else range(len(self))[key])

    @cached_property
    def row_of_uid(self) -> dict[str, int]:
        """Row of each uid."""
        return {uid: row for row, uid in enumerate(self.uid)}

    def row(self, name: str) -> int:
        """Row of the first entity with that name; KeyError if there is none."""
        try:
            return self.name.index(name)
        except ValueError:
            raise KeyError(f"no entity is named {name!r}") from None

    def category_name(self, row: int) -> str:
        """The category of a row, "" for none."""
        index = self.category[row]
        return self.vocabulary[index] if index >= 0 else ""

    def replace(self, **changes: Any) -> SceneGraph:
        """A copy with some columns exchanged."""
        return replace(self, **changes)

    def with_component(self, name: str, component: Table) -> SceneGraph:
        """A copy with a component table added, replaced, or (if it is empty) removed."""
        others = {key: value for key, value in self.components.items() if key != name}
        return self.replace(components=others | ({name: component} if len(component.rows) else {}))
