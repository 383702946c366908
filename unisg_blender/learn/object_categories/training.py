"""Fits the model of categories: known shapes, a word list, counts of neighbours."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from ...errors import UniSGError
from ...meshes.normalise import size_channels
from ...meshes.shape_feature import AtlasNetEncoder
from ...meshes.shape_files import ShapeFile
from ...meshes.similar import quarter_turn_features
from ...predict.calibration import top_features
from ...predict.category_model import LabelModel, distances, nearest_of_class
from ...predict.category_proposals import beside
from ...predict.name_evidence import words
from ...scene.graph import SceneGraph
from ...words.room_kinds import room_kind
from ..atlasnet.world_shapes import OF_WORLDS

NAME_WEIGHT = 13.0
BESIDE_WEIGHT = 0.8
QUARTER_TURNS = 4
FARTHEST = 1e3
LIGHTLY = 1e-4
"""How much a square of a weight costs, nats."""


def fit_labels(
    models: Sequence[ShapeFile], scenes: Sequence[SceneGraph], encoder: AtlasNetEncoder, provenance: dict,
    progress: Callable[[int], None] = lambda done: None, judges: Sequence[ShapeFile] = (),
) -> LabelModel:  # fmt: skip
    """Fit a model of categories.

    Parameters
    ----------
    models
        Meshes with a category in their real size, Z up; the ones without are left out.
    scenes
        Scenes with categories, for the habits of standing together; may be empty.
    encoder
        Gives the mesh features.
    provenance
        Goes into the model's file.
    judges
        Other meshes, by which it is told how often the model is right; what has no category of the models is
        nothing that it can know. Without any, each of the models is judged by those of other families.

    Raises
    ------
    UniSGError
        If there are fewer than two categories.
    """
    known = [model for model in models if model.category]
    vocabulary = tuple(sorted({model.category for model in known}))
    if len(vocabulary) < 2:
        raise UniSGError("needs meshes of two categories or more: put each category into a folder of its own")
    known.sort(key=lambda model: model.category)
    vectors, raw = shape_inputs(known, encoder, progress)
    sizes = size_channels(raw)
    classes = np.repeat([vocabulary.index(model.category) for model in known], QUARTER_TURNS)
    families = np.repeat(np.unique([model.family for model in known], return_inverse=True)[1], QUARTER_TURNS)
    spread = float(np.linalg.norm(vectors - vectors.mean(axis=0), axis=1).mean())
    apart = distances(vectors, sizes, vectors, sizes, spread)
    warmth = temperature(apart, classes, families)
    if judges:
        asked, raw = shape_inputs(judges, encoder)
        nearest = nearest_of_class(distances(asked, size_channels(raw), vectors, sizes, spread), classes)
        truth = np.repeat([(*vocabulary, model.category).index(model.category) for model in judges], QUARTER_TURNS)
    else:
        nearest, truth = _of_other_families(known, apart, classes, families)
    return LabelModel(
        vocabulary=vocabulary,
        vectors=vectors.astype(np.float16),
        sizes=sizes.astype(np.float32),
        classes=classes.astype(np.int32),
        spread=spread,
        temperature=warmth,
        lexicon=tuple(build_lexicon(vocabulary, known)),
        together=standing_together(scenes, vocabulary).astype(np.float32),
        name_weight=NAME_WEIGHT,
        beside_weight=BESIDE_WEIGHT,
        provenance=provenance | {"meshes": len(known)},
        settings=settings_of(scenes, vocabulary),
        trust=trust(nearest, truth, warmth),
    )


def shape_inputs(
    models: Sequence[ShapeFile], encoder: AtlasNetEncoder, progress: Callable[[int], None] = lambda done: None
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Mesh features (4 N, 1024) of models in four quarter turns, and sizes (4 N, 3) in metres."""
    vectors, sizes = [], []
    for done, model in enumerate(models):
        vectors.append(quarter_turn_features(model.mesh, encoder))
        sizes += [model.mesh.bounds[1] - model.mesh.bounds[0]] * QUARTER_TURNS
        progress(done)
    return np.concatenate(vectors), np.array(sizes)


def temperature(apart: NDArray[np.float64], classes: NDArray[np.integer], families: NDArray[np.integer]) -> float:
    """Divisor of the distances (M, M) under which what is nearest in other families says most about the class.

    Only classes of two families or more tell anything.
    """
    apart = np.where(families[:, None] == families, np.inf, apart)
    nearest = nearest_of_class(apart, classes)
    asked = np.isfinite(nearest[np.arange(len(classes)), classes])
    if not asked.any():
        return 0.1
    options = np.geomspace(0.01, 1, 40)
    return float(options[np.argmax([_log_likelihood(-nearest[asked] / t, classes[asked]) for t in options])])


def _log_likelihood(scores: NDArray[np.float64], truth: NDArray[np.int64]) -> float:
    best = scores.max(axis=1)
    total = best + np.log(np.exp(scores - best[:, None]).sum(axis=1))
    return float((scores[np.arange(len(truth)), truth] - total).mean())


def _of_other_families(
    known: Sequence[ShapeFile], apart: NDArray[np.float64], classes: NDArray[np.integer], families: NDArray[np.integer]
) -> tuple[NDArray[np.float64], NDArray[np.integer]]:
    """Distances (N, K) of the shapes from files to those of other families in each category, and their own category."""
    of_files = [not model.family.startswith(OF_WORLDS) for model in known]  # what is made by rule tells nothing
    mine = np.flatnonzero(np.repeat(of_files, QUARTER_TURNS))[::QUARTER_TURNS]
    nearest = nearest_of_class(np.where(families[mine, None] == families, np.inf, apart[mine]), classes)
    possible = np.isfinite(nearest[np.arange(len(mine)), classes[mine]])
    return np.minimum(nearest[possible], FARTHEST), classes[mine][possible]


def trust(nearest: NDArray[np.float64], truth: NDArray[np.integer], warmth: float) -> tuple[float, ...]:
    """How often the best guess is right, by logistic regression on :func:`~...predict.calibration.top_features`.

    ``nearest`` (N, K) are distances to the known shapes of each category, of which ``truth`` (N,) is the right one.
    Empty of nothing.
    """
    return _logistic(top_features(-nearest / warmth, nearest), nearest.argmin(axis=1) == truth) if len(truth) else ()


def _logistic(inputs: NDArray[np.float64], truth: NDArray[np.bool_]) -> tuple[float, ...]:
    """Weights (F,) of a logistic regression, lightly held to zero."""
    sign = np.where(truth, 1.0, -1.0)

    def loss(found: NDArray[np.float64]) -> float:
        return float(np.logaddexp(0, -sign * (inputs @ found)).mean() + LIGHTLY * found @ found)

    found = minimize(loss, np.zeros(inputs.shape[1]), method="BFGS").x
    return tuple(np.round(found, 4).tolist())


def settings_of(scenes: Sequence[SceneGraph], vocabulary: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """By kind of room the categories that only its scenes have; nothing where the scenes are of one kind."""
    seen: dict[str, set[str]] = {}
    for graph in scenes:
        things = {name for name in graph.vocabulary if name in vocabulary}
        if kind := room_kind(things):
            seen.setdefault(kind, set()).update(things)
    if len(seen) < 2:
        return {}
    others = {kind: set().union(*(seen[other] for other in seen if other != kind)) for kind in seen}
    return {kind: tuple(sorted(seen[kind] - others[kind])) for kind in sorted(seen)}


def build_lexicon(vocabulary: Sequence[str], models: Sequence[ShapeFile]) -> list[dict[str, float]]:
    """Words of each category: its own (the last one fully, the others half), and those of its models' names."""
    lexicon = []
    for category in vocabulary:
        own = words(category)
        names = Counter(w for model in models if model.category == category for w in set(words(model.name)))
        entry = {word: 0.4 for word in names}
        lexicon.append(entry | {word: 0.5 for word in own[:-1]} | {word: 1.0 for word in own[-1:]})
    return lexicon


def standing_together(scenes: Sequence[SceneGraph], vocabulary: Sequence[str]) -> NDArray[np.float64]:
    """(K, K): log of how much oftener than by chance two categories stand beside each other; 0 for unknown pairs."""
    place = {name: index for index, name in enumerate(vocabulary)}
    counts = np.zeros((len(vocabulary), len(vocabulary)))
    for graph in scenes:
        kinds = np.array([place.get(graph.category_name(row), -1) for row in range(len(graph))])
        first, second = beside(graph)
        both = (kinds[first] >= 0) & (kinds[second] >= 0)
        np.add.at(counts, (kinds[first[both]], kinds[second[both]]), 1)
    total = counts.sum()
    if not total:
        return counts
    row, column = counts.sum(axis=1, keepdims=True), counts.sum(axis=0, keepdims=True)
    expected = row * column / total
    ratio = np.log((counts + 1) / (expected + 1))
    return np.where((row > 0) & (column > 0), np.clip(ratio, -2, 2), 0.0)
