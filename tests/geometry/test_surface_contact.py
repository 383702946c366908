"""Heights and gaps of triangles, beside scipy's interpolation and trimesh's nearest points."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import LinearNDInterpolator
from trimesh.triangles import closest_point

from unisg_blender.geometry.surface_contact import contact_heights, heights, surface_gap, within


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


def test_contacts_of_dense_surfaces_need_memory_for_what_meets_only() -> None:
    """Every line through 2 x 45,000 triangles meets one or two of each: pairs of all of them would be 10^11 numbers."""
    steps = np.linspace(-1, 1, 151)
    corner = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    plan = np.concatenate([np.stack(some, axis=-2).reshape(-1, 3, 2) for some in ((a, b, c), (a, c, d))])
    wave = 0.05 * np.sin(3 * plan[..., :1])
    lower = np.concatenate([plan, wave], axis=-1)
    upper = np.concatenate([plan, wave + 0.004], axis=-1)[:, ::-1]
    found = contact_heights(upper, lower, np.array([-1, -1, -0.2]), np.array([1, 1, 0.2]), 0.005, 0.01)
    assert len(found) > 100
    assert np.abs(found).max() <= 0.05
    apart = upper + np.array([0, 0, 0.01])
    assert not len(contact_heights(apart, lower, np.array([-1, -1, -0.2]), np.ones(3), 0.005, 0.01))
