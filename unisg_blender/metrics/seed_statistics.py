"""What repeated measurements say: intervals of their mean, paired tests, and a correction for many tests."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

RESAMPLED = 10_000
LEVELS = (0.025, 0.975)


def interval(values: Any) -> dict[str, float]:
    """Mean over seeds, and half the width of its 95 % confidence interval by Student's t; NaN for one seed."""
    from scipy.stats import t

    array = np.asarray(values, np.float64)
    count = len(array)
    half = float(t.ppf(LEVELS[1], count - 1) * array.std(ddof=1) / np.sqrt(count)) if count > 1 else float("nan")
    return {"mean": float(array.mean()), "half_width": half, "seeds": count}


def bounded_interval(values: Any) -> tuple[float, float]:
    """95 % interval of the mean that stays where the values are: shares have none beyond 1; NaN for one seed.

    Percentiles of a bootstrap over the seeds. Source: Efron, Tibshirani, "An Introduction to the Bootstrap" (1993).
    """
    array = np.asarray(values, np.float64)
    if len(array) < 2:
        return float("nan"), float("nan")
    drawn = np.random.default_rng(0).integers(len(array), size=(RESAMPLED, len(array)))
    low, high = np.quantile(array[drawn].mean(axis=1), LEVELS)
    return float(low), float(high)


def paired_test(
    first: NDArray[np.float64], second: NDArray[np.float64], alternative: Literal["two-sided", "less"] = "two-sided"
) -> float:
    """p of Wilcoxon's signed-rank test that paired values (N,) are alike; NaN under 10 pairs, or if none differ.

    ``alternative``: "less" asks whether the first are smaller. Pairs with a value that is no number are left out.
    Source: Wilcoxon, "Individual comparisons by ranking methods" (1945).
    """
    from scipy.stats import wilcoxon

    both = np.isfinite(first) & np.isfinite(second)
    if both.sum() < 10 or not (first[both] != second[both]).any():
        return float("nan")
    return float(wilcoxon(first[both], second[both], alternative=alternative).pvalue)


def holm(p: Sequence[float]) -> list[float]:
    """p (N,) of one family of tests, corrected so that it says how likely any false one is; NaN stays and counts not.

    Source: Holm, "A simple sequentially rejective multiple test procedure" (1979).
    """
    values = np.asarray(p, np.float64)
    order = np.argsort(values, kind="stable")[: np.isfinite(values).sum()]
    corrected = np.full(len(values), np.nan)
    factors = np.arange(len(order), 0, -1)
    corrected[order] = np.minimum(np.maximum.accumulate(values[order] * factors), 1.0)
    return corrected.tolist()
