from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unisg_blender.metrics.seed_statistics import bounded_interval, holm, interval, paired_test

SHARES = st.lists(st.floats(0, 1), min_size=2, max_size=12)


@given(SHARES)
def test_intervals_of_shares_stay_between_0_and_1_and_hold_the_mean(values: list[float]) -> None:
    low, high = bounded_interval(values)
    assert 0 <= low <= high <= 1
    assert low - 1e-12 <= np.mean(values) <= high + 1e-12


def test_where_bounds_are_far_both_intervals_agree() -> None:
    values = np.random.default_rng(1).normal(0.5, 0.02, 200)
    low, high = bounded_interval(values)
    assert high - low == pytest.approx(2 * interval(values)["half_width"], rel=0.05)
    assert np.isnan(bounded_interval([0.5])).all()


def test_the_paired_test_sees_small_but_steady_differences() -> None:
    rng = np.random.default_rng(0)
    base = rng.exponential(20, 60)
    assert paired_test(base, base + 1, "less") < 1e-6
    assert paired_test(base + 1, base, "less") > 0.99
    assert paired_test(base + 1, base) < 1e-6
    assert 0.01 < paired_test(base, rng.permutation(base)) < 0.99
    assert np.isnan(paired_test(base[:5], base[:5] + 1))
    assert np.isnan(paired_test(base, base))
    some = np.where(np.arange(60) < 55, base + 1, np.nan)
    assert paired_test(base, some, "less") < 1e-6


def test_holm_is_that_of_the_textbook() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.5, 0.9]) == pytest.approx([1.0, 1.0])
    corrected = holm([0.01, np.nan, 0.02])
    assert corrected[0] == pytest.approx(0.02)
    assert np.isnan(corrected[1])
