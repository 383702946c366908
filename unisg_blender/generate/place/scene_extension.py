"""Put objects into a scenegraph: new rows, and nothing that was there before is changed."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...dataset.assets.asset import Asset
from ...geometry.arrays import Floats
from ...scene import Material, Mesh, SceneGraph, Table, canonical, table, world_matrices
from ...scene.assembly import index_categories
from ...scene.identity import derived_uid, new_uid
from ..observe.observed_scene import within

UidMaker = Callable[[str], str]


@dataclass(frozen=True, eq=False)
class Addition:
    """An object to add: ``parent`` is a uid of the scene or of another addition ("" for none), ``world`` its matrix.

    ``relation`` is what it is to its parent ("on_top_of" ...), "" for nothing said.
    """

    asset: Asset
    uid: str
    name: str
    parent: str
    world: Floats
    category: str
    relation: str = ""


def uid_maker(graph: SceneGraph, seed: int | None) -> UidMaker:
    """Gives a new uid for a name: random, or with a seed always the same for the same scene."""
    if seed is None:
        return lambda name: new_uid()
    digest = hashlib.blake2b("\0".join(sorted(graph.uid)).encode("utf-8", "surrogatepass"), digest_size=16)
    base, given = f"{seed} {digest.hexdigest()}", [0]

    def make(name: str) -> str:
        """The next uid for a name."""
        given[0] += 1
        return derived_uid(f"{base} {given[0]}", name)

    return make


class Names:
    """Names that no object has yet: "Scalpel", "Scalpel.001" ..."""

    def __init__(self, taken: Iterable[str]) -> None:
        self._taken = set(taken)
        self._next: dict[str, int] = {}

    def new(self, base: str) -> str:
        """The first free name out of a base name."""
        number, name = self._next.get(base, 0), base
        while name in self._taken:
            number += 1
            name = f"{base}.{number:03d}"
        self._next[base] = number
        self._taken.add(name)
        return name


def extend(graph: SceneGraph, additions: Sequence[Addition], names: Names, make_uid: UidMaker) -> SceneGraph:
    """The scenegraph with the additions; rows are in canonical order again.

    Children in the hierarchy get ``local`` relative to their parent's world matrix.
    Actions of an asset stay behind: they are about objects of another scene (see :mod:`..behaviour`).
    """
    if not additions:
        return graph
    world = dict(zip(graph.uid, world_matrices(graph), strict=True))
    place = {uid: row for row, uid in enumerate(graph.uid)}
    grown = _Growing(graph, place)
    for addition in additions:
        local = addition.world
        if addition.parent:
            local = within(world[addition.parent], addition.world)
        world[addition.uid] = addition.world
        grown.add(addition, local, names, make_uid)
    return canonical(_with_relations(grown.build(), additions))


class _Growing:
    """Columns that rows are appended to."""

    def __init__(self, graph: SceneGraph, place: dict[str, int]) -> None:
        self.graph = graph
        self.place = place
        self.name, self.uid = list(graph.name), list(graph.uid)
        self.type, self.parent = graph.type.tolist(), graph.parent.tolist()
        self.category = [graph.category_name(row) for row in range(len(graph))]
        self.local, self.mesh = [graph.local], graph.mesh.tolist()
        self.meshes: list[Mesh] = list(graph.meshes)
        self.mesh_place = {id(mesh): number for number, mesh in enumerate(self.meshes)}
        self.materials: dict[str, Material] = dict(graph.materials)
        self.tables: dict[str, list[tuple[int, Table]]] = {}

    def add(self, addition: Addition, local: Floats, names: Names, make_uid: UidMaker) -> None:
        """Append the entities of an asset with its root at ``local`` (4, 4), metres, in its parent's frame."""
        part, start = addition.asset.graph, len(self.name)
        renamed = self._take_materials(part.materials)
        for row in range(len(part)):
            self.name.append(addition.name if row == 0 else names.new(part.name[row]))
            self.uid.append(addition.uid if row == 0 else make_uid(part.name[row]))
            self.parent.append(start + part.parent[row] if row else self.place.get(addition.parent, -1))
            self.category.append(addition.category if row == 0 else part.category_name(row))
            self.mesh.append(self._take_mesh(part.meshes[part.mesh[row]], renamed) if part.mesh[row] >= 0 else -1)
        self.type += part.type.tolist()
        self.local.append(np.concatenate([local[None], part.local[1:]]))
        self.place[addition.uid] = start
        for name, rows in part.components.items():
            if name != "actions":
                self.tables.setdefault(name, []).append((start, rows))

    def _take_materials(self, materials: Mapping[str, Material]) -> dict[str, str]:
        """Take in materials; returns new names for those whose names stand for something else here."""
        renamed = {}
        for name, material in materials.items():
            if self.materials.setdefault(name, material) != material:
                number = 1
                while self.materials.setdefault(new := f"{name}.{number:03d}", replace(material, name=new)) != replace(
                    material, name=new
                ):
                    number += 1
                renamed[name] = new
        return renamed

    def _take_mesh(self, mesh: Mesh, renamed: Mapping[str, str]) -> int:
        if id(mesh) not in self.mesh_place:
            self.mesh_place[id(mesh)] = len(self.meshes)
            slots = tuple(renamed.get(name, name) for name in mesh.materials)
            self.meshes.append(mesh if slots == mesh.materials else replace(mesh, materials=slots))
        return self.mesh_place[id(mesh)]

    def build(self) -> SceneGraph:
        """The scene with all that was appended."""
        category, vocabulary = index_categories(self.category)
        components = dict(self.graph.components)
        for name, parts in self.tables.items():
            components[name] = _append(components.get(name), parts)
        return self.graph.replace(
            name=tuple(self.name), uid=tuple(self.uid), type=np.array(self.type, np.int8),
            parent=np.array(self.parent, np.int32), category=category, vocabulary=vocabulary,
            local=np.concatenate(self.local), mesh=np.array(self.mesh, np.int32), meshes=tuple(self.meshes),
            materials=self.materials, components=components,
        )  # fmt: skip


def _append(before: Table | None, parts: Sequence[tuple[int, Table]]) -> Table:
    """A table with further rows, which lie behind its own; parts with other columns are left out."""
    kept = [part for part in parts if before is None or part[1].columns.keys() == before.columns.keys()]
    if before is None:
        before = kept[0][1].take(np.zeros(0, np.int64), 1 + int(kept[0][1].rows.max(initial=0)))
        kept = [part for part in kept if part[1].columns.keys() == before.columns.keys()]
    rows = [before.rows, *(part.rows + start for start, part in kept)]
    columns = {
        name: np.concatenate([values, *(part.columns[name] for _, part in kept)])
        for name, values in before.columns.items()
    }
    return Table(np.concatenate(rows).astype(np.int32), columns)


def _with_relations(graph: SceneGraph, additions: Sequence[Addition]) -> SceneGraph:
    related = [item for item in additions if item.relation and item.parent]
    if not related:
        return graph
    rows = [graph.row_of_uid[item.uid] for item in related]
    added = table(rows, kind=[item.relation for item in related], target=[item.parent for item in related])
    return graph.with_component("relations", _joined(graph.components.get("relations"), added))


def _joined(before: Table | None, added: Table) -> Table:
    """Two tables of the same columns as one."""
    whole = added if before is None else _append(before, [(0, added)])
    order = np.argsort(whole.rows, kind="stable")
    return Table(whole.rows[order], {name: column[order] for name, column in whole.columns.items()})
