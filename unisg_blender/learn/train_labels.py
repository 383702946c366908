"""Fits the model of categories: discriminant analysis of shapes, a word list, counts of neighbours."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..meshes.feature import AtlasNetEncoder
from ..meshes.label import beside
from ..meshes.label_model import LabelModel, size_channels
from ..meshes.models import Model
from ..meshes.names import words
from ..meshes.networks import PRETRAINED
from ..meshes.similar import quarter_turn_features
from ..scene.graph import SceneGraph

COMPONENTS = 48
SHRINKAGE = 0.3
NAME_WEIGHT = 8.0
BESIDE_WEIGHT = 0.5
QUARTER_TURNS = 4
WORDS_FILE = PRETRAINED / "labels_words.json"


def fit_labels(
    models: Sequence[Model],
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
    inputs, sizes = shape_inputs(known, encoder, progress)
    classes = np.repeat([vocabulary.index(model.category) for model in known], QUARTER_TURNS)
    families = np.repeat(np.unique([model.family for model in known], return_inverse=True)[1], QUARTER_TURNS)
    full = np.concatenate([inputs, size_channels(sizes)], axis=1)
    weights, bias = discriminant(full, classes, families, len(vocabulary))
    heat = temperature(full, classes, families, len(vocabulary))
    return LabelModel(
        vocabulary=vocabulary,
        weights=(weights / heat).astype(np.float32),
        bias=(bias / heat).astype(np.float32),
        lexicon=tuple(build_lexicon(vocabulary, known)),
        together=standing_together(scenes, vocabulary).astype(np.float32),
        name_weight=NAME_WEIGHT,
        beside_weight=BESIDE_WEIGHT,
        provenance=provenance | {"models": len(known), "temperature": round(heat, 3)},
    )


def shape_inputs(
    models: Sequence[Model], encoder: AtlasNetEncoder, progress: Callable[[int], None] = lambda done: None
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Mesh features (4 N, 1024) of models in four quarter turns, and sizes (4 N, 3) in metres."""
    vectors, sizes = [], []
    for done, model in enumerate(models):
        vectors.append(quarter_turn_features(model.mesh, encoder))
        sizes += [model.mesh.bounds[1] - model.mesh.bounds[0]] * QUARTER_TURNS
        progress(done)
    return np.concatenate(vectors), np.array(sizes)


def discriminant(
    inputs: NDArray[np.floating], classes: NDArray[np.integer], families: NDArray[np.integer], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Linear discriminant analysis: weights (count, D) and bias (count,) of the log-likelihoods.

    The mesh feature is first reduced to its main components; the covariance
    around the class means, every family counting once, is shrunk towards the
    diagonal of all inputs. Classes that do not occur have a bias of minus
    infinity.
    """
    share = 1 / np.bincount(families)[families]
    inputs = np.asarray(inputs, np.float64)
    mean = np.average(inputs, axis=0, weights=share)
    scale = np.full(
        inputs.shape[1], np.sqrt(np.average((inputs[:, :-3] - mean[:-3]) ** 2, weights=share, axis=0).mean())
    )
    scale[-3:] = 1.0
    centred = (inputs - mean) / scale
    _, _, axes = np.linalg.svd(centred[:, :-3] * np.sqrt(share)[:, None], full_matrices=False)
    axes = axes[:COMPONENTS]
    reduced = np.concatenate([centred[:, :-3] @ axes.T, centred[:, -3:]], axis=1)
    total = np.bincount(classes, share, count)
    means = np.stack([np.bincount(classes, share * column, count) for column in reduced.T], axis=1)
    means = means / np.maximum(total, 1e-12)[:, None]
    around = (reduced - means[classes]) * np.sqrt(share)[:, None]
    within = around.T @ around / max(share.sum() - (total > 0).sum(), 1.0)
    overall = np.average(reduced**2, axis=0, weights=share)
    within = (1 - SHRINKAGE) * within + SHRINKAGE * np.diag(overall)
    solved = np.linalg.solve(within, means.T).T
    weights = np.concatenate([solved[:, :-3] @ axes, solved[:, -3:]], axis=1) / scale
    bias = -0.5 * np.einsum("kd,kd->k", solved, means) - weights @ mean
    return weights, np.where(total > 0, bias, -1e4)


def temperature(
    inputs: NDArray[np.floating], classes: NDArray[np.integer], families: NDArray[np.integer], count: int
) -> float:
    """Divisor of the scores under which held-out families have the best log-likelihood, in five folds."""
    scores, truth = held_out_scores(inputs, classes, families, count)
    options = np.geomspace(0.5, 20, 40)
    return float(options[np.argmax([_log_likelihood(scores / option, truth) for option in options])])


def held_out_scores(
    inputs: NDArray[np.floating],
    classes: NDArray[np.integer],
    families: NDArray[np.integer],
    count: int,
    folds: int = 5,
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Scores (M, count) of samples by fits without their family, and their classes, where the class remains known."""
    scores, truth = [], []
    fold = np.random.default_rng(0).permutation(families.max() + 1)[families] % folds
    for number in range(folds):
        kept, out = fold != number, fold == number
        weights, bias = discriminant(inputs[kept], classes[kept], families[kept], count)
        out &= np.isin(classes, classes[kept])
        scores.append(inputs[out].astype(np.float64) @ weights.T + bias)
        truth.append(classes[out])
    return np.concatenate(scores), np.concatenate(truth)


def _log_likelihood(scores: NDArray[np.float64], truth: NDArray[np.int64]) -> float:
    best = scores.max(axis=1)
    total = best + np.log(np.exp(scores - best[:, None]).sum(axis=1))
    return float((scores[np.arange(len(truth)), truth] - total).mean()) if len(truth) else 0.0


def build_lexicon(vocabulary: Sequence[str], models: Sequence[Model]) -> list[dict[str, float]]:
    """Words of each category: its own (the last one fully, the others half), its synonyms, and its models' names."""
    synonyms = json.loads(WORDS_FILE.read_text(encoding="utf-8"))
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
