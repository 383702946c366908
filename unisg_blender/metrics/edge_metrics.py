"""How well edges were found: average precision, area under the ROC curve, F1.

Written with numpy since measuring must work without scikit-learn, which is in the extra "figures" only. Where no pair
is true there is no precision to average, so that average precision is NaN; F1 is then 1 if nothing was found, else 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.arrays import Bools, Ints


def average_precision(score: NDArray[np.floating], truth: Bools) -> float:
    """Sum over thresholds of (recall gained) x (precision); ties in score count as one threshold.

    ``score`` and ``truth`` are (P,), of P pairs. AP = sum_k (R_k - R_{k-1}) P_k, 0..1.
    Source: Zhu, "Recall, precision and average precision", 2004; the same as
    scikit-learn's ``average_precision_score``. NaN where no pair is true.
    """
    total = int(truth.sum())
    if not total:
        return float("nan")
    right, called = _at_thresholds(score, truth)
    gained = np.diff(right, prepend=0) / total
    return float((gained * right / called).sum())


def area_under_roc(score: NDArray[np.floating], truth: Bools) -> float:
    """Chance that a true pair scores higher than a false one, ties half, 0..1 (Hanley and McNeil, 1982).

    ``score`` and ``truth`` are (P,), of P pairs; NaN without true or without false ones.
    """
    positives, negatives = int(truth.sum()), int((~truth).sum())
    if not positives or not negatives:
        return float("nan")
    right, called = _at_thresholds(score, truth)
    hit, false = np.append(0, right) / positives, np.append(0, called - right) / negatives
    return float((np.diff(false) * (hit[1:] + hit[:-1]) / 2).sum())


def f1_score(found: Bools, truth: Bools, missed: int = 0) -> float:
    """2 TP / (2 TP + FP + FN), 0..1; 1 where there is nothing to find and nothing was found.

    ``found`` and ``truth`` are (P,), of P pairs; ``missed`` counts true ones that were not among them at all.
    """
    right = int((found & truth).sum())
    wrong = int(found.sum()) + int(truth.sum()) + missed
    return 2 * right / wrong if wrong else 1.0


def best_threshold(score: NDArray[np.floating], truth: Bools) -> float:
    """The score from which on pairs are called true where F1 is greatest, of validation: both (P,)."""
    order = np.sort(np.unique(score))[::-1]
    right, called = _at_thresholds(score, truth)
    return float(order[np.argmax(2 * right / (called + max(int(truth.sum()), 1)))])


def _at_thresholds(score: NDArray[np.floating], truth: Bools) -> tuple[Ints, Ints]:
    """True pairs among the called ones, and the called ones, at every distinct score, highest first."""
    order = np.argsort(-score, kind="stable")
    last = np.append(np.flatnonzero(np.diff(score[order])), len(score) - 1)
    return np.cumsum(truth[order])[last], last + 1
