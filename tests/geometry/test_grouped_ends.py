"""The ends of each group are those of what is in it."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from unisg_blender.geometry.grouped_ends import grouped_ends


@given(st.lists(st.tuples(st.integers(0, 4), st.floats(-9, 9), st.floats(0, 3))))
def test_ends_are_those_of_each_group(rows: list[tuple[int, float, float]]) -> None:
    group = np.array([number for number, _, _ in rows], np.int64)
    low = np.array([[start, -start] for _, start, _ in rows]).reshape(-1, 2)
    high = low + np.array([[longer] for _, _, longer in rows]).reshape(-1, 1)
    least, greatest = grouped_ends(group, 5, low, high)
    alone = grouped_ends(group, 5, low)
    for number in range(5):
        mine = group == number
        np.testing.assert_array_equal(least[number], low[mine].min(axis=0, initial=np.inf))
        np.testing.assert_array_equal(greatest[number], high[mine].max(axis=0, initial=-np.inf))
        np.testing.assert_array_equal(alone[0][number], least[number])
        np.testing.assert_array_equal(alone[1][number], low[mine].max(axis=0, initial=-np.inf))
