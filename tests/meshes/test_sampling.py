from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from unisg_blender.errors import UniSGError
from unisg_blender.meshes.sampling import NoSurfaceError, eliminate, poisson_radius, sample_surface
from unisg_blender.scene import Mesh, mesh_from_faces

from .shapes import box, joined, sphere


def spacing(points: np.ndarray) -> np.ndarray:
    return cKDTree(points).query(points, k=2)[0][:, 1]


@pytest.mark.parametrize("mesh", [box(), sphere(), joined(box(), box((2, 1, 0.5), (5, 0, 0)))], ids=lambda m: m.name)
def test_distances_are_blue_noise(mesh: Mesh) -> None:
    samples = sample_surface(mesh, 1500, 3)
    radius = poisson_radius(samples.area, 1500)
    apart = spacing(samples.points.astype(np.float64)) / radius
    assert apart.min() > 0.55  # dart throwing at its densest reaches 0.7; uniform random points have about 0.01
    assert np.median(apart) > 0.65


@settings(max_examples=25, deadline=None)
@given(count=st.integers(1, 300), seed=st.integers(0, 2**31))
def test_exact_count_on_the_surface_by_seed(count: int, seed: int) -> None:
    mesh = box((1, 2, 3))
    samples, again = sample_surface(mesh, count, seed), sample_surface(mesh, count, seed)
    assert samples.points.shape == samples.normals.shape == (count, 3)
    assert np.array_equal(samples.points, again.points)
    inside = samples.points / (1, 2, 3)
    assert ((inside > -1e-6) & (inside < 1 + 1e-6)).all()
    face_distance = np.minimum(np.abs(inside), np.abs(inside - 1)).min(axis=1)
    assert face_distance.max() < 1e-6
    outwards = np.einsum("nk,nk->n", samples.points - np.array([0.5, 1, 1.5]), samples.normals)
    assert (outwards > 0).all()
    assert np.allclose(np.linalg.norm(samples.normals, axis=1), 1, atol=1e-6)


def test_elimination_equals_removing_one_by_one() -> None:
    generator = np.random.default_rng(5)
    points, count = generator.random((90, 3)) * (1, 1, 0.01), 30
    reach = poisson_radius(1.0, count)
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    weight = np.where((distance < reach) & (distance > 0), (1 - np.minimum(distance / reach, 1)) ** 8, 0)
    alive = np.ones(90, bool)
    for _ in range(90 - count):
        crowding = np.where(alive, weight[:, alive].sum(axis=1), -1)
        alive[np.argmax(crowding)] = False
    assert np.array_equal(eliminate(points, count, 1.0), np.flatnonzero(alive))


def test_share_of_each_part_follows_its_area() -> None:
    mesh = joined(box(), box((3, 3, 3), (10, 0, 0)))
    samples = sample_surface(mesh, 2000)
    assert (samples.points[:, 0] < 5).mean() == pytest.approx(0.1, abs=0.02)


def test_one_face_and_faces_without_area() -> None:
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0], [0, 0, 0]]
    samples = sample_surface(mesh_from_faces("one", np.array(points, float), [[0, 1, 2], [0, 1, 3], [0, 4, 1]]), 64)
    assert (samples.faces == 0).all()
    assert (samples.points[:, :2].sum(axis=1) <= 1 + 1e-6).all()
    assert np.allclose(samples.normals, [0, 0, 1])


def test_non_manifold_faces_on_one_edge() -> None:
    points = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [-1, 0, 0], [0, 1, 0]], float)
    samples = sample_surface(mesh_from_faces("fan", points, [[0, 1, 2], [0, 1, 3], [0, 1, 4]]), 300)
    assert np.bincount(samples.faces, minlength=3).min() > 80


def test_concave_face_keeps_its_notch_empty() -> None:
    outline = np.array([[2, 2, 0], [0, 4, 0], [0, 0, 0], [4, 0, 0], [4, 4, 0]], float)
    samples = sample_surface(mesh_from_faces("notch", outline, [[0, 1, 2, 3, 4]]), 400)
    assert samples.area == pytest.approx(12)
    x, y, _ = samples.points.T
    assert (y - 2 <= np.abs(x - 2) + 1e-5).all()


def test_points_that_are_not_finite_are_left_out() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [np.nan, 0, 0], [0, np.inf, 1]])
    samples = sample_surface(mesh_from_faces("broken", points, [[0, 1, 2], [0, 1, 3], [1, 2, 4]]), 50)
    assert np.isfinite(samples.points).all()
    assert (samples.faces == 0).all()


@pytest.mark.parametrize("faces", [[], [[0, 1, 1]], [[0, 1]]])
def test_no_surface_is_an_error(faces: list) -> None:
    mesh = mesh_from_faces("cloud", np.eye(3), faces)
    with pytest.raises(NoSurfaceError, match="'cloud' has no surface"):
        sample_surface(mesh, 10)


def test_no_samples_is_an_error() -> None:
    with pytest.raises(UniSGError, match="1 or more"):
        sample_surface(box(), 0)


def test_very_small_and_far_away() -> None:
    samples = sample_surface(box((1e-3, 1e-3, 1e-3), (100, 100, 100)), 200)
    assert len(samples.points) == 200
