"""Confidences that are right as often as they say, and the settings in which categories make sense."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import expit, logsumexp, softmax

from ..geometry.arrays import Bools, Floats

KNOWN = 0.7
"""Confidence from which on a thing counts as known; below it the honest answer is "I do not know"."""

ENOUGH = 3
"""Things of a room by which its kind can be told."""

OUT_OF_PLACE = 2.0
"""Nats by which a category is less likely in a room of a kind in which it was never seen."""


def top_features(scores: Floats, apart: Floats) -> Floats:
    """What tells how far a best guess can be trusted, (N, 3): 1, the log of its chance, and its distance.

    Parameters
    ----------
    scores
        Evidence (N, K), nats.
    apart
        Distances (N, K) to the nearest known shape of each category.
    """
    best = scores.argmax(axis=1)
    each = np.arange(len(scores))
    chance = scores[each, best] - logsumexp(scores, axis=1)
    return np.stack([np.ones(len(scores)), chance, apart[each, best]], axis=1)


def calibrated(scores: Floats, apart: Floats, trust: Sequence[float]) -> Floats:
    """Chances (N, K) whose best is right as often as it says; what is left is shared by the others, and by what the
    model does not know. Without ``trust`` they are those of the scores."""
    chances = softmax(scores, axis=1)
    if not len(trust):
        return np.asarray(chances)
    best, each = scores.argmax(axis=1), np.arange(len(scores))
    sure = expit(top_features(scores, apart) @ np.asarray(trust, float))
    rest = np.where(np.arange(scores.shape[1]) == best[:, None], 0, chances)
    shares = np.minimum((1 - sure)[:, None] * rest, (1 - 1e-6) * sure[:, None])  # the best stays the best
    shares[each, best] = sure
    return np.asarray(shares)


def setting_evidence(
    scores: Floats, given: Sequence[str], vocabulary: Sequence[str], settings: Mapping[str, Sequence[str]]
) -> Floats:
    """Evidence (K,) of the kind of room for categories that were seen in one kind of rooms only, nats, 0 or below.

    Parameters
    ----------
    scores
        Evidence (N, K) of the things without a category.
    given
        The categories that things of the room have.
    """
    if not settings or len(scores) + len(given) < ENOUGH:
        return np.zeros(len(vocabulary))
    only = np.array([[name in names for name in vocabulary] for names in settings.values()])
    out_of_place = OUT_OF_PLACE * (only.any(axis=0) & ~only)
    likely = logsumexp(scores[None] - out_of_place[:, None], axis=2).sum(axis=1)
    known = np.array([name in vocabulary for name in given], bool)
    places = [vocabulary.index(name) for name, is_known in zip(given, known, strict=True) if is_known]
    likely = likely - out_of_place[:, places].sum(axis=1)
    chance = softmax(likely)
    return np.asarray(-(out_of_place * only.any(axis=0) * _unlikely(only, chance)).max(axis=0))


def _unlikely(only: Bools, chance: Floats) -> Floats:
    """How much less likely than the likeliest kind (S,) that of each category is, (1, K) in 0..1."""
    own = np.where(only.any(axis=0), (only * chance[:, None]).max(axis=0), chance.max())
    return np.asarray(1 - own / chance.max())[None]
