"""Put objects into a scenegraph: new rows, and nothing that was there before is changed."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ...dataset.assets.asset import Asset
from ...geometry.arrays import Floats
from ...scene import SceneGraph, table
from ...scene.assembly import index_categories
from ...scene.component_table import joined
from ...scene.components import ACTIONS, RELATIONS
from ...scene.identity import derived_uid, new_uid
from ...scene.merge import append
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
    world = dict(zip(graph.uid, graph.world, strict=True))
    parts = []
    for addition in additions:
        local = within(world[addition.parent], addition.world) if addition.parent else addition.world
        world[addition.uid] = addition.world
        parts.append(_part(addition, local, names, make_uid))
    return append(graph, parts, [addition.parent for addition in additions])


def _part(addition: Addition, local: Floats, names: Names, make_uid: UidMaker) -> SceneGraph:
    """The entities of an asset with its root at ``local`` (4, 4), metres, in its parent's frame."""
    graph = addition.asset.graph
    categories = [addition.category, *(graph.category_name(row) for row in range(1, len(graph)))]
    category, vocabulary = index_categories(categories)
    components = {name: kept for name, kept in graph.components.items() if name != ACTIONS}
    if addition.relation and addition.parent:
        said = table([0], kind=[addition.relation], target=[addition.parent])
        before = components.get(RELATIONS)
        components[RELATIONS] = said if before is None else joined([(before, 0), (said, 0)])
    return graph.replace(
        name=(addition.name, *map(names.new, graph.name[1:])),
        uid=(addition.uid, *map(make_uid, graph.name[1:])),
        category=category,
        vocabulary=vocabulary,
        local=np.concatenate([local[None], graph.local[1:]]),
        components=components,
    )
