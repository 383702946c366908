"""Fits the model of categories: known shapes, a word list, counts of neighbours."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...meshes.normalise import size_channels
from ...meshes.shape_feature import AtlasNetEncoder
from ...meshes.shape_files import ShapeFile
from ...meshes.similar import quarter_turn_features
from ...predict.category_model import LabelModel, distances, nearest_of_class
from ...predict.category_proposals import beside
from ...predict.name_evidence import words
from ...pretrained import FOLDER
from ...scene.graph import SceneGraph

NAME_WEIGHT = 8.0
BESIDE_WEIGHT = 0.5
QUARTER_TURNS = 4
WORDS_FILE = FOLDER / "labels_words.json"


def fit_labels(
    models: Sequence[ShapeFile],
    scenes: Sequence[SceneGraph],
    encoder: AtlasNetEncoder,
    provenance: dict,
    progress: Callable[[int], None] = lambda done: None,
) -> LabelModel:
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
    return LabelModel(
        vocabulary=vocabulary,
        vectors=vectors.astype(np.float16),
        sizes=sizes.astype(np.float32),
        classes=classes.astype(np.int32),
        spread=spread,
        temperature=temperature(distances(vectors, sizes, vectors, sizes, spread), classes, families),
        lexicon=tuple(build_lexicon(vocabulary, known, json.loads(WORDS_FILE.read_text(encoding="utf-8")))),
        together=standing_together(scenes, vocabulary).astype(np.float32),
        name_weight=NAME_WEIGHT,
        beside_weight=BESIDE_WEIGHT,
        provenance=provenance | {"meshes": len(known)},
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


def build_lexicon(
    vocabulary: Sequence[str], models: Sequence[ShapeFile], synonyms: Mapping[str, Sequence[str]]
) -> list[dict[str, float]]:
    """Words of each category: its own (the last one fully, the others half), its synonyms, and its models' names."""
    lexicon = []
    for category in vocabulary:
        own = words(category)
        names = Counter(w for model in models if model.category == category for w in set(words(model.name)))
        entry = {word: 0.4 for word in names}
        entry |= {word: 0.5 for word in own[:-1]} | {word: 1.0 for word in own[-1:]}
        lexicon.append(entry | {word: 1.0 for word in synonyms.get(category, ())})
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
