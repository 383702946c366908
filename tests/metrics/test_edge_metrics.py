"""Average precision, ROC area and F1: by hand, and as scikit-learn has them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.metrics.edge_metrics import area_under_roc, average_precision, best_threshold, f1_score


def test_by_hand() -> None:
    score, truth = np.array([0.9, 0.8, 0.7, 0.1]), np.array([True, False, True, False])
    assert average_precision(score, truth) == pytest.approx(0.5 * 1 + 0.5 * 2 / 3)
    assert area_under_roc(score, truth) == pytest.approx(3 / 4)
    assert f1_score(score >= 0.7, truth) == pytest.approx(4 / 5)
    assert f1_score(score >= 0.7, truth, missed=1) == pytest.approx(4 / 6)
    assert best_threshold(score, truth) == 0.7
    assert f1_score(np.zeros(3, bool), np.zeros(3, bool)) == 1.0


def test_no_true_pair_has_no_precision() -> None:
    assert np.isnan(average_precision(np.ones(2), np.zeros(2, bool)))
    assert np.isnan(area_under_roc(np.ones(2), np.ones(2, bool)))
    assert np.isnan(average_precision(np.zeros(0), np.zeros(0, bool)))
    assert f1_score(np.ones(2, bool), np.zeros(2, bool)) == 0.0
    assert f1_score(np.zeros(2, bool), np.zeros(2, bool), missed=1) == 0.0


@settings(deadline=None)
@given(st.integers(0, 2**31))
def test_average_precision_is_that_of_its_definition(seed: int) -> None:
    rng = np.random.default_rng(seed)
    score, truth = rng.permutation(20).astype(float), rng.random(20) < 0.3
    ranked = truth[np.argsort(-score)]
    precision = [ranked[: place + 1].mean() for place in np.flatnonzero(ranked)]
    expected = np.mean(precision) if precision else np.nan
    assert average_precision(score, truth) == pytest.approx(expected, nan_ok=True)


@pytest.mark.slow
@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(0, 6), st.booleans()), min_size=2, max_size=60))
def test_as_scikit_learn_with_ties(pairs: list[tuple[int, bool]]) -> None:
    metrics = pytest.importorskip("sklearn.metrics")
    score, truth = np.array([a for a, _ in pairs], float), np.array([b for _, b in pairs])
    if truth.all() or not truth.any():
        return
    assert average_precision(score, truth) == pytest.approx(metrics.average_precision_score(truth, score))
    assert area_under_roc(score, truth) == pytest.approx(metrics.roc_auc_score(truth, score))
    assert f1_score(score >= 3, truth) == pytest.approx(metrics.f1_score(truth, score >= 3, zero_division=0))
    limit = best_threshold(score, truth)
    best = max(f1_score(score >= other, truth) for other in np.unique(score))
    assert f1_score(score >= limit, truth) == pytest.approx(best)
