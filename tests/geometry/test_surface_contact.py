"""Heights and gaps of triangles, beside scipy's interpolation and trimesh's nearest points."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import LinearNDInterpolator
from trimesh.triangles import closest_point

from unisg_blender.geometry.surface_contact import heights, surface_gap, within


def test_heights_are_those_of_the_planes() -> None:
    rng = np.random.default_rng(0)
    triangles, places = rng.normal(size=(20, 3, 3)), rng.normal(size=(50, 2)) * 0.5
    found = heights(places, triangles)
    for column, triangle in zip(found.T, triangles, strict=True):
        np.testing.assert_allclose(column, LinearNDInterpolator(triangle[:, :2], triangle[:, 2])(places), atol=1e-9)
    assert 0 < np.isfinite(found).sum() < found.size


def test_gaps_are_distances_of_nearest_points() -> None:
    """A corner of one surface is nearest to the other, however they lie: the other is far wider."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        small, wide = rng.normal(size=(4, 3, 3)) * 0.1 + [0, 0, 1], rng.normal(size=(1, 3, 3)) * [9, 9, 0.1]
        corners = small.reshape(-1, 3)
        expected = np.linalg.norm(corners - closest_point(np.repeat(wide, 12, axis=0), corners), axis=1).min()
        np.testing.assert_allclose(surface_gap(small, wide), expected, rtol=1e-9)


def test_only_what_reaches_into_the_box_is_within() -> None:
    triangles = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[5, 0, 0], [6, 0, 0], [5, 1, 0]]], float)
    assert within(triangles, np.array([-1.0, -1, -1]), np.array([0.0, 0, 0])).tolist() == triangles[:1].tolist()
    assert len(within(triangles, np.array([2.0, -1, -1]), np.array([4.0, 1, 1]))) == 0
