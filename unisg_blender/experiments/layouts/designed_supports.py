"""Who stands on whom in rooms that others designed: the geometric rule, a score of boxes, and a trained model.

All ordered pairs of different objects count, except those that the source tells in another way; see
:mod:`...metrics.edge_metrics`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...generate.observe.observed_scene import ObservedScene
from ...generate.propose.anchor_proposer import AnchorProposer
from ...metrics.edge_metrics import average_precision, f1_score
from ...scene import SceneGraph, world_matrices
from ...spatial.objects import scene_objects
from ...spatial.relations import find_relations
from .designed_rooms import DesignedRoom

if TYPE_CHECKING:
    from ...generate import Generator
    from ...predict.support_prediction import TopologyModel

Scores = Callable[[SceneGraph], NDArray[np.float64]]
"""Scores (N, N) of a scene: that the row stands on (or in) the column."""

REACH = 0.03
"""Metres between bottom and top at which the score of boxes has fallen to 1/e."""

OURS = {
    "Arm Chair": "Armchair", "TV Stand": "Television Stand", "Remote Control": "Remote", "Pillow": "Cushion",
    "House Plant": "Plant", "Painting": "Picture", "Side Table": "Side Table", "Shelving Unit": "Shelf", "Mug": "Cup",
    "tv": "Television", "tvstand": "Television Stand", "coffeetable": "Coffee Table", "bookshelf": "Bookshelf",
    "pillow": "Cushion", "sofa": "Sofa", "book": "Book", "mug": "Cup", "floor": "Floor", "chair": "Chair", "rug": "Rug",
    "remotecontrol": "Remote", "tablelamp": "Table Lamp", "orchid": "Plant", "wallpictureframe": "Picture",
}  # fmt: skip
"""Their names for categories of our worlds, where they differ."""


@dataclass(frozen=True)
class SupportRow:
    """Average precision and F1 of a method in one room."""

    room: str
    method: str
    objects: int
    pairs: int
    average_precision: float
    f1: float

    def to_record(self) -> dict[str, Any]:
        """JSON-ready."""
        return {key: round(value, 4) if isinstance(value, float) else value for key, value in self.__dict__.items()}


def by_rule(graph: SceneGraph, kinds: Sequence[str] = ("on_top_of", "inside")) -> NDArray[np.float64]:
    """1 where the relations computed from geometry are of some ``kinds``."""
    scores = np.zeros((len(graph), len(graph)))
    for row, kind, target in find_relations(graph):
        if kind in kinds:
            scores[row, target] = 1.0
    return scores


def by_boxes(graph: SceneGraph) -> NDArray[np.float64]:
    """Share of the footprint that lies over the other's, times exp(-(gap / 3 cm)) between bottom and top."""
    low, high = bounds_of(graph)
    shared = np.clip(
        np.minimum(high[:, None], high[None])[..., :2] - np.maximum(low[:, None], low[None])[..., :2], 0, None
    )
    own = np.maximum((high - low)[:, :2].prod(axis=1), 1e-9)
    gap = np.abs(low[:, None, 2] - high[None, :, 2])
    scores: NDArray[np.float64] = shared.prod(axis=2) / own[:, None] * np.exp(-gap / REACH)
    np.fill_diagonal(scores, 0.0)
    return scores


def bounds_of(graph: SceneGraph) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Axis-aligned boxes of the rows in the world, (N, 3) each."""
    world = world_matrices(graph)
    points = [
        graph.meshes[mesh].points @ world[row, :3, :3].T + world[row, :3, 3] for row, mesh in enumerate(graph.mesh)
    ]
    return np.array([each.min(axis=0) for each in points]), np.array([each.max(axis=0) for each in points])


def by_rule_on_top(graph: SceneGraph) -> NDArray[np.float64]:
    """1 where the geometric rule says on top of; what it takes to lie inside a box does not count."""
    return by_rule(graph, ("on_top_of",))


def by_topology(model: TopologyModel) -> Scores:
    """Chances from the trained network over pairs; 0 for pairs that are no candidates."""

    def scores(graph: SceneGraph) -> NDArray[np.float64]:
        """Chances (N, N) that a row stands on another by the relation model."""
        found = np.zeros((len(graph), len(graph)))
        for row, _, target, chance in model.find(graph, 0.0):
            found[row, target] = chance
        return found

    return scores


def by_model(generator: Generator) -> Scores:
    """The generator's probabilities of supports: from categories and sizes only, positions are not looked at."""

    proposer = AnchorProposer(generator.model)

    def scores(graph: SceneGraph) -> NDArray[np.float64]:
        """Chances (N, N) that a row stands on another by the generator's choice of supports."""
        renamed = graph.replace(vocabulary=tuple(OURS.get(name, name) for name in graph.vocabulary))
        objects = scene_objects(renamed, generator.categories)
        scene = ObservedScene.of(objects, world_matrices(graph)[objects.row])
        scene.support = np.full(len(scene.support), -1)  # nothing is known of what stands on what
        found, each = np.zeros((len(graph), len(graph))), np.arange(len(objects))
        for obj in range(len(objects)):
            category = int(scene.category[obj]) if scene.category[obj] >= 0 else len(generator.categories)
            chances = proposer.support_chances(scene, category, scene.half[obj], each != obj)
            found[objects.row[obj], objects.row] = chances
        return found

    return scores


def times(one: Scores, two: Scores) -> Scores:
    """The product of two scores."""
    return lambda graph: one(graph) * two(graph)


def support_table(rooms: Sequence[DesignedRoom], methods: Sequence[tuple[str, Scores, float]]) -> list[SupportRow]:
    """Each method (name, scores, threshold for F1) in each room that says what stands on what, and over all of them."""
    rows: list[SupportRow] = []
    pooled: list[tuple[list[Any], list[Any]]] = [([], []) for _ in methods]
    told = [room for room in rooms if room.supports is not None]
    for room in told:
        count = len(room.graph)
        true, asked = np.zeros((count, count), bool), ~np.eye(count, dtype=bool)
        for row, on in room.supports or ():
            true[row, on] = True
        for row, on in room.unclear:
            asked[row, on] = asked[on, row] = False
        asked |= true
        for (name, scores, least), (values_of, truth_of) in zip(methods, pooled, strict=True):
            values = scores(room.graph)[asked]
            values_of.append(values)
            truth_of.append(true[asked])
            rows.append(_row(room.name, name, count, values, true[asked], least))
    objects = sum(len(room.graph) for room in told)
    for (name, _, least), (values_of, truth_of) in zip(methods, pooled, strict=True):
        if told:
            rows.append(_row("all", name, objects, np.concatenate(values_of), np.concatenate(truth_of), least))
    return rows


def _row(
    room: str, name: str, objects: int, values: NDArray[np.float64], true: NDArray[np.bool_], least: float
) -> SupportRow:
    return SupportRow(
        room, name, objects, int(true.sum()), average_precision(values, true), f1_score(values >= least, true)
    )
