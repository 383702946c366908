"""Proposed categories for the entities of a scene, from shape, size, name and neighbours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import softmax

from ..geometry.arrays import Floats, Ints
from ..geometry.planar import rotation
from ..meshes.normalise import normalise
from ..meshes.shape_feature import POINTS, AtlasNetEncoder, cloud, default_encoder
from ..scene.assembly import index_categories
from ..scene.graph import SceneGraph
from ..scene.hierarchy import local_bounds, world_matrices
from ..spatial import oriented_boxes
from ..spatial.structure.building_rows import building_rows
from ..words import VocabularyMatch
from ..words.scene_words import is_shape_name
from .calibration import KNOWN, calibrated, setting_evidence
from .category_model import LabelModel
from .name_evidence import NameEvidence
from .things_as_one import things_as_one

BESIDE = 0.5
"""Boxes whose spheres come nearer than this, in metres, stand beside each other."""
MOST_NEIGHBOURS = 12

SURE = 0.9
"""Confidence of what the structure of a room, or a word that the model lacks, tells."""

NAMED = 0.97
"""Confidence of what a name says, all categories together."""

BY_GEOMETRY = ("Floor", "Wall", "Ceiling")
"""Categories that are told by where something is, never by how it looks."""

RULED_OUT = 50.0
"""Nats against them."""

NOTHING_SAID = NameEvidence(np.zeros(0))


@dataclass(frozen=True)
class Proposal:
    """What an entity may be: ``row`` and ``uid`` of the entity; categories with confidences in 0..1, best first."""

    row: int
    uid: str
    name: str
    categories: tuple[tuple[str, float], ...]

    @property
    def best(self) -> str:
        """The most likely category."""
        return self.categories[0][0]

    @property
    def confidence(self) -> float:
        """Confidence of the most likely category."""
        return self.categories[0][1]

    @property
    def known(self) -> bool:
        """Whether the model knows what it is: otherwise the honest answer is "I do not know"."""
        return self.confidence >= KNOWN


def propose_categories(
    graph: SceneGraph, model: LabelModel | None = None, encoder: AtlasNetEncoder | None = None, *,
    rows: Sequence[int] | None = None, best: int = 3, use: Sequence[str] = ("shape", "name", "neighbours", "structure"),
    words: Mapping[str, str] | None = None,
) -> list[Proposal]:  # fmt: skip
    """Propose categories for entities that have a mesh, or stand for several that are one thing, and no category.

    Parameters
    ----------
    graph
        Any scene in metres.
    model, encoder
        The shipped ones when omitted.
    rows
        Entities to look at, categorised or not; those without a mesh are skipped.
    best
        How many categories to name for each entity.
    use
        Kinds of evidence: "shape" (mesh and size), "name", "neighbours" (what stands beside it, and in what kind of
        room), and "structure": what is floor, wall or ceiling of a room is told by where it is, not by how it looks.
    words
        What the user says of words in names: word to category.

    Returns
    -------
    One proposal per entity, in row order.
    """
    model, encoder = model or LabelModel.load(), encoder or default_encoder()
    building = building_rows(graph) if "structure" in use else {}
    whole = things_as_one(graph, building)
    wanted = np.flatnonzero(whole.category < 0) if rows is None else np.array(sorted(rows), np.int64)
    wanted = wanted[np.array([_has_points(whole, row) for row in wanted], bool)]
    if not len(wanted):
        return []
    names = _names(whole, wanted, model, words) if "name" in use else [NOTHING_SAID] * len(wanted)
    chances = _chances(whole, wanted, names, model, encoder, use)
    proposals = []
    for row, said, own in zip(wanted.tolist(), names, chances, strict=True):
        sure = building.get(row, said.thing)
        told = [(sure, SURE)] if sure else []
        left = 1 - sum(chance for _, chance in told)
        order = [k for k in np.argsort(-own, kind="stable") if model.vocabulary[k] != sure]
        told += [(model.vocabulary[k], left * float(own[k])) for k in order[: best - len(told)]]
        proposals.append(Proposal(row, graph.uid[row], graph.name[row], tuple(told)))
    return proposals


def _names(graph: SceneGraph, wanted: Ints, model: LabelModel, words: Mapping[str, str] | None) -> list[NameEvidence]:
    match = VocabularyMatch(model.vocabulary, words) if words else model.words
    found = {}
    for row in wanted.tolist():
        own = graph.meshes[graph.mesh[row]].name
        found[row] = model.read_names((graph.name[row], "" if is_shape_name(own) else own), match)
    return list(found.values())


def _chances(
    graph: SceneGraph, wanted: Ints, names: Sequence[NameEvidence], model: LabelModel, encoder: AtlasNetEncoder,
    use: Sequence[str],
) -> Floats:  # fmt: skip
    """(M, K): the chance of each category by all evidence but the structure of rooms."""
    by_name = np.stack([said.scores if len(said.scores) else np.zeros(len(model.vocabulary)) for said in names])
    shape = model.shape_scores(*_shapes(graph, wanted, encoder)) if "shape" in use else np.zeros_like(by_name)
    scores = shape + by_name
    built = np.array([name in BY_GEOMETRY for name in model.vocabulary])
    if not built.all():
        scores -= RULED_OUT * (built & (by_name == 0))  # a name may say so
    if "neighbours" in use:
        given = [graph.category_name(int(row)) for row in np.flatnonzero(graph.category >= 0)]
        scores += setting_evidence(scores, given, model.vocabulary, model.settings)
        scores += model.beside_weight * _neighbour_scores(graph, wanted, softmax(scores, axis=1), model)
    if "shape" not in use:
        return np.asarray(softmax(scores, axis=1))
    trusted = calibrated(scores, -shape * model.temperature, model.trust)
    return np.where(by_name.any(axis=1)[:, None], NAMED * softmax(scores, axis=1), trusted)


def accept(graph: SceneGraph, proposals: Sequence[Proposal], threshold: float = 0.0) -> SceneGraph:
    """The scene with the best category of each proposal whose confidence reaches a threshold."""
    names = [graph.category_name(row) for row in range(len(graph))]
    for proposal in proposals:
        if proposal.confidence >= threshold:
            names[proposal.row] = proposal.best
    category, vocabulary = index_categories(names)
    return graph.replace(category=category, vocabulary=vocabulary)


def beside(graph: SceneGraph) -> tuple[Ints, Ints]:
    """Pairs of rows with meshes that stand beside each other, in both directions: at most twelve of a row.

    Objects larger than three metres (floors, walls) are nobody's neighbours.
    """
    boxes = oriented_boxes(graph)
    size = 2 * boxes.half.max(axis=1)
    rows = np.flatnonzero(boxes.solid & (size < 3) & np.isfinite(boxes.center).all(axis=1))
    if len(rows) < 2:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    center, radius = boxes.center[rows], size[rows] / 2
    count = min(MOST_NEIGHBOURS + 1, len(rows))
    distance, near = map(np.asarray, cKDTree(center).query(center, count))
    close = distance <= radius[:, None] + radius[near] + BESIDE
    close &= near != np.arange(len(rows))[:, None]
    first, second = np.nonzero(close)
    return rows[first], rows[near[first, second]]


def _has_points(graph: SceneGraph, row: int) -> bool:
    return graph.mesh[row] >= 0 and bool(np.isfinite(graph.meshes[graph.mesh[row]].points).all(axis=1).any())


def _shapes(graph: SceneGraph, rows: Ints, encoder: AtlasNetEncoder) -> tuple[NDArray[np.float32], Floats]:
    """Mesh features (M, 1024) as the entities stand, their heading taken back, and sizes (M, 3) in metres."""
    world = world_matrices(graph)[rows, :3, :3]
    heading = np.arctan2(world[:, 1, 0], world[:, 0, 0])
    upright = rotation(-heading) @ world
    bounds = local_bounds(graph)[rows]
    sizes = np.einsum("nij,nj->ni", np.abs(upright), bounds[:, 1] - bounds[:, 0])
    scale = np.maximum(np.linalg.norm(upright, axis=(1, 2), keepdims=True), 1e-30)
    keys = [
        (int(mesh), shape.tobytes())
        for mesh, shape in zip(graph.mesh[rows], np.round(upright / scale, 2) + 0.0, strict=True)
    ]
    first = {key: number for number, key in reversed(list(enumerate(keys)))}
    clouds = [normalise(cloud(graph.meshes[key[0]], POINTS) @ upright[number].T)[0] for key, number in first.items()]
    shape = {key: number for number, key in enumerate(first)}
    return encoder.encode_clouds(clouds)[[shape[key] for key in keys]], sizes


def _neighbour_scores(graph: SceneGraph, wanted: Ints, chances: Floats, model: LabelModel) -> Floats:
    """(M, K): the mean affinity to the neighbours, whose categories are given or, if not, likely to be."""
    belief = np.zeros((len(graph), len(model.vocabulary)))
    belief[wanted] = chances
    for row in np.flatnonzero(graph.category >= 0):
        belief[row] = [name == graph.category_name(int(row)) for name in model.vocabulary]
    first, second = beside(graph)
    total, count = np.zeros_like(belief), np.zeros(len(graph))
    np.add.at(total, first, belief[second] @ model.together.T)
    np.add.at(count, first, 1)
    return (total / np.maximum(count, 1)[:, None])[wanted]
