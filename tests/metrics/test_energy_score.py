"""The energy score: zero for certain and right draws, moved with the scene, and proper."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unisg_blender.metrics.energy_score import energy_scores


def test_draws_on_the_truth_cost_nothing_and_wrong_ones_their_distance() -> None:
    true = np.array([1.0, 2.0, 0.5, 3.0])
    assert energy_scores(np.tile(true, (4, 1)), true) == (0, 0)
    off = np.tile(true + np.array([3, 4, 0, np.pi / 2]), (4, 1))
    assert energy_scores(off, true) == pytest.approx((5, 90))


@given(seed=st.integers(0, 2**32 - 1), turn=st.floats(-3, 3))
def test_moving_and_turning_everything_changes_nothing(seed: int, turn: float) -> None:
    rng = np.random.default_rng(seed)
    places, true = rng.normal(0, 2, (8, 4)), rng.normal(0, 2, 4)
    moved = np.append(rng.normal(0, 5, 3), turn)
    assert energy_scores(places + moved, true + moved) == pytest.approx(energy_scores(places, true), abs=1e-6)


@pytest.mark.parametrize(("spread", "shift"), [(0.2, 0.0), (3.0, 0.0), (1.0, 1.5)])
def test_who_draws_as_the_truth_is_drawn_scores_best(spread: float, shift: float) -> None:
    rng = np.random.default_rng(0)
    true = rng.normal(0, 1, (400, 4)) * (1, 1, 1, 0)
    right = np.mean([energy_scores(rng.normal(0, 1, (32, 4)) * (1, 1, 1, 0), one)[0] for one in true])
    wrong = np.mean([energy_scores(rng.normal(shift, spread, (32, 4)) * (1, 1, 1, 0), one)[0] for one in true])
    assert right < wrong
