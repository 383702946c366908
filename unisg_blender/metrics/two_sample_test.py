"""Can a classifier tell generated scenes from real ones: the classifier two-sample test (C2ST).

Source: Lopez-Paz and Oquab, "Revisiting Classifier Two-Sample Tests" (ICLR 2017).
A random forest of 500 trees (Breiman 2001) is trained to tell real from generated
objects, pairs or scenes; its accuracy on scenes that it has not seen is 0.5 where
the two cannot be told apart, and 1 where they can every time.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import MissingPackageError
from ..geometry.arrays import Floats, Ints
from ..geometry.planar import wrapped
from .layout_features import ANGLE, LENGTH, OBJECT, PAIR, Features, scene_kinds

TREES, FOLDS = 500, 3
ARM = 0.5
"""An angle gets the noise of a length at this distance, metres: 3 cm are 3.4 degrees."""

NOISES = (0.03, 0.01)
LEVELS = ("objects", "pairs", "scene")


def c2st(
    real: Sequence[Features], made: Sequence[Features], level: str, noise: float, vocabulary: tuple[str, ...],
    seed: int = 0, trees: int = TREES,
) -> Floats:  # fmt: skip
    """Share of right answers for each scene, real ones first, float64 (len(real) + len(made),); NaN without any.

    Scene k of both sides falls into the same fold, so that a classifier never sees
    one scene's counterpart. Mean of the result: the accuracy.

    Parameters
    ----------
    level
        "objects", "pairs" or "scene".
    noise
        Standard deviation of what is added to every length, metres, and by
        :data:`ARM` to every angle; so traces that no eye sees do not decide.

    Raises
    ------
    MissingPackageError
        Without scikit-learn.
    """
    try:
        from sklearn.ensemble import RandomForestClassifier
    except ImportError:
        raise MissingPackageError("scikit-learn", "figures") from None

    kinds = {"objects": list(OBJECT.values()), "pairs": list(PAIR.values()), "scene": scene_kinds(vocabulary)}[level]
    rng = np.random.default_rng((seed, len(level)))
    parts = [np.atleast_2d(getattr(features, level)) for features in (*real, *made)]
    owner = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    values = noisy(np.concatenate(parts), np.asarray(kinds), noise, rng)
    truth = owner >= len(real)
    pair = np.where(truth, owner - len(real), owner)
    fold = rng.permutation(max(len(real), len(made)))[pair] % FOLDS
    right = np.full(len(owner), np.nan)
    for number in range(FOLDS):
        told, asked = fold != number, fold == number
        if asked.any() and truth[told].any() and not truth[told].all():  # else there are fewer scenes than folds
            forest = RandomForestClassifier(trees, random_state=seed, n_jobs=1)
            right[asked] = forest.fit(values[told], truth[told]).predict(values[asked]) == truth[asked]
    count = np.bincount(owner, minlength=len(parts))
    with np.errstate(invalid="ignore"):
        return np.bincount(owner, weights=right, minlength=len(parts)) / count


def noisy(values: Floats, kinds: Ints, noise: float, rng: np.random.Generator) -> NDArray[np.float32]:
    """The features with noise; angles become cosines and sines behind the others."""
    length, angle = kinds == LENGTH, kinds == ANGLE
    drawn = rng.standard_normal(values.shape)
    values = values + noise * drawn * length + noise / ARM * drawn * angle
    turns = wrapped(values[:, angle])
    return np.concatenate([values[:, ~angle], np.cos(turns), np.sin(turns)], axis=1).astype(np.float32)
