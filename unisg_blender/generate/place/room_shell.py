"""What is built before things come: the shell of a new room, of one kept beside the model, or a floor under walls."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from ...dataset.assets.asset import Asset
from ...errors import UniSGError
from ...geometry.arrays import Floats
from ...scene import SceneGraph, subtree, take, world_matrices
from ...scene.categories import FLOOR, STRUCTURE
from ...spatial.structure.missing_floor import floor_plane
from .growing_scene import GrowingScene
from .placement_record import Placement
from .scene_extension import Addition, Names, UidMaker, extend
from .shape_library import Library
from .spanning_objects import reaches


def add_shell(
    scene: SceneGraph, counts: Mapping[str, int], library: Library, rng: np.random.Generator, names: Names,
    make_uid: UidMaker,
) -> tuple[SceneGraph, list[Placement]]:  # fmt: skip
    """The scene with a room shell whose counts come nearest to those asked for, and what became of each part.

    Raises
    ------
    UniSGError
        If the model has no shells beside it.
    """
    start = time.perf_counter()
    wanted = {name: int(counts[name]) for name in STRUCTURE if name in counts}
    shells = library.shells
    if not shells:
        raise UniSGError("the model has no room shells beside it: add to a scene that has a floor, or export again")
    missing = np.array([_difference(shell.graph, wanted) for shell in shells])
    best = np.flatnonzero(missing == missing.min())
    drawn = rng.permutation(best)
    contract = library.model.contract
    spanning = [contract.vocabulary.index(name) for name in contract.priors.spanning if name in counts]
    rooms = [shells[int(number)].graph for number in drawn]
    graph = next((room for room in rooms if _is_reached_across(room, spanning, library)), rooms[0])
    rows = _chosen(graph, wanted)
    world = world_matrices(graph)
    additions: dict[int, Addition] = {}
    for row in rows:
        kind, above = graph.category_name(row), additions.get(int(graph.parent[row]))
        part, uid = Asset(kind, take(graph, np.array([row]))), make_uid(kind)
        relation = _relation(library, graph, row) if above else ""
        additions[row] = Addition(part, uid, names.new(kind), above.uid if above else "", world[row], kind, relation)
    spent = 1e3 * (time.perf_counter() - start) / max(len(rows), 1)
    name_of = {"": ""} | {item.uid: item.name for item in additions.values()}
    placements = [
        Placement(item.category, item.name, item.uid, name_of[item.parent], item.world, milliseconds=spent)
        for item in additions.values()
    ]
    left = Counter(wanted) - Counter(item.category for item in additions.values())
    placements += [Placement(kind, note="the rooms beside the model have no more") for kind in left.elements()]
    return extend(scene, [*additions.values()], names, make_uid), placements


def add_floor(
    scene: SceneGraph, ends: Floats, names: Names, make_uid: UidMaker
) -> tuple[SceneGraph, list[Placement]]:  # fmt: skip
    """The scene with a floor between two corners (2, 3) under walls that have none, and what is told of it."""
    start = time.perf_counter()
    part = floor_plane(ends)
    item = Addition(Asset(FLOOR, part), make_uid(FLOOR), names.new(FLOOR), "", part.local[0], FLOOR)
    result = extend(scene, [item], names, make_uid)
    spent = 1e3 * (time.perf_counter() - start)
    note = "the walls had no floor: a plane was put under them"
    return result, [Placement(FLOOR, item.name, item.uid, world=item.world, milliseconds=spent, note=note)]


def _is_reached_across(graph: SceneGraph, spanning: Sequence[int], library: Library) -> bool:
    """Is there for each category that is to span a room a shape that reaches across this one?"""
    if not spanning:
        return True
    scene = GrowingScene(graph, library.model.contract)
    return all(
        any(
            reaches(scene.observed, scene.usual_holders(category), placeable.half)
            for placeable in library.placeables(category, graph)
        )
        for category in spanning
    )


def _difference(graph: SceneGraph, wanted: Mapping[str, int]) -> int:
    have = Counter(graph.category_name(row) for row in range(len(graph)))
    return sum(abs(have[name] - count) for name, count in wanted.items())


def _chosen(graph: SceneGraph, wanted: Mapping[str, int]) -> list[int]:
    """Rows of the shell that were asked for, at most as many of each kind, without what hangs under others left out."""
    left, dropped, rows = Counter(wanted), set(), []
    for row in range(len(graph)):
        kind = graph.category_name(row)
        if row in dropped or left[kind] <= 0:
            dropped.update(subtree(graph, row).tolist())
            continue
        left[kind] -= 1
        rows.append(row)
    return rows


def _relation(library: Library, graph: SceneGraph, row: int) -> str:
    """What a part of the room usually is to what holds it."""
    priors = library.model.contract.priors
    prior = priors.prior(graph.category_name(row), graph.category_name(int(graph.parent[row])))
    return prior.relation if prior else ""
