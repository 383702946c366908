"""Ends of small shapes, beside numpy's own way."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.geometry.corner_ends import corner_ends, meeting_ends


@pytest.mark.parametrize("shape", [(0, 3, 3), (1, 2, 3), (50, 3, 3), (20, 8, 3), (30, 3, 2)])
def test_ends_are_the_least_and_the_greatest_of_the_corners(shape):
    shapes = np.random.default_rng(0).normal(size=shape)
    low, high = corner_ends(shapes)
    np.testing.assert_array_equal(low, shapes.min(axis=1))
    np.testing.assert_array_equal(high, shapes.max(axis=1))


def test_boxes_meet_where_they_overlap_along_every_axis_or_touch():
    low = np.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 1.5], [-3, -3, -3]], float)
    meets = meeting_ends(low, low + 1, np.array([0.5, 0.5, 0.5]), np.array([1.0, 1.0, 1.0]))
    assert meets.tolist() == [True, False, True, False, False]
