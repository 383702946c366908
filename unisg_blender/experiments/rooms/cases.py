"""What a generator is asked in the benchmark: rooms to furnish, and half-emptied rooms to complete."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...dataset.assets.asset import Asset, object_graph
from ...geometry.arrays import Bools, Floats
from ...metrics.requested_relations import place_of
from ...scene import SceneGraph, take, world_matrices
from ...scene.categories import STRUCTURE, has_category
from ...scene.parents import with_rows_below
from ...spatial import find_supports
from ...spatial.object_rows import object_rows


@dataclass(frozen=True, eq=False)
class Case:
    """A room to furnish: the real one, its shell, and the objects to put in, by category."""

    real: SceneGraph
    shell: SceneGraph
    assets: dict[str, list[Asset]]
    wanted: dict[str, int]


@dataclass(frozen=True, eq=False)
class Hole:
    """A room of which half was taken out, and one object of it that is to come back.

    Attributes
    ----------
    real, rest
        The room as it was, and what is left of it.
    asset
        The object's shape.
    support
        uid of what it stood on, which is still there.
    neighbour
        uid of the nearest object on the same support that is still there, "" for none.
    places
        (K, 4): x, y, bottom and turn of the objects of its category that were taken out, its own first.
    supports
        uids of what those stood on.
    """

    real: SceneGraph
    rest: SceneGraph
    asset: Asset
    support: str
    neighbour: str
    places: Floats
    supports: tuple[str, ...]

    @property
    def category(self) -> str:
        """Category of the object."""
        return self.asset.category


def case_of(graph: SceneGraph, known: Sequence[str]) -> Case | None:
    """The test case of a room, None if there is nothing to move; what the model does not know stays where it is."""
    movable = _movable(graph, known)
    if not movable.any():
        return None
    assets: dict[str, list[Asset]] = {}
    owner, world = object_rows(graph), world_matrices(graph)
    for row in np.flatnonzero(movable):
        assets.setdefault(graph.category_name(row), []).append(object_graph(graph, int(row), owner, world))
    shell = without(graph, movable)
    return Case(graph, shell, assets, {name: len(group) for name, group in assets.items()})


def hole_of(graph: SceneGraph, known: Sequence[str], seed: int) -> Hole | None:
    """A room without a random half of its objects and what stands on them, and one of these; None if none is left.

    The object asked for is drawn among the categories first, so that rare ones count as much as common ones.
    """
    rng = np.random.default_rng((seed, 77))
    movable = _movable(graph, known)
    gone = with_rows_below(graph.parent, movable & (rng.random(len(graph)) < 0.5))
    on = find_supports(graph).by_row
    taken = np.flatnonzero(gone & movable & (on >= 0) & ~gone[on])
    if not len(taken):
        return None
    kinds = graph.category[taken]
    kind = rng.choice(np.unique(kinds))
    alike = rng.permutation(taken[kinds == kind])
    row = int(alike[0])
    beside = np.flatnonzero((on == on[row]) & ~gone & movable)
    world = world_matrices(graph)[:, :3, 3]
    near = beside[np.linalg.norm(world[beside] - world[row], axis=1).argsort()]
    places = np.array([place_of(graph, int(other)) for other in alike])
    return Hole(
        graph, without(graph, gone), object_graph(graph, row), graph.uid[on[row]],
        graph.uid[near[0]] if len(near) else "", places, tuple(graph.uid[on[other]] for other in alike),
    )  # fmt: skip


def _movable(graph: SceneGraph, known: Sequence[str]) -> Bools:
    return has_category(graph, {*known} - {*STRUCTURE}) & (graph.mesh >= 0)


def without(graph: SceneGraph, gone: Bools) -> SceneGraph:
    """The scene without some rows and all that hangs under them; of its components only the relations stay."""
    shell = take(graph, np.flatnonzero(~with_rows_below(graph.parent, gone)))
    return shell.replace(components={name: value for name, value in shell.components.items() if name == "relations"})
