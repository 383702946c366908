"""Matrices as rows of numbers do what numpy and scipy do with matrices."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import polar
from scipy.spatial.transform import Rotation

from unisg_blender.geometry import affine_rows


@pytest.fixture
def matrices() -> np.ndarray:
    """Eight affine matrices (8, 4, 4) with scale, shear and, in half of them, a mirror."""
    found = np.tile(np.eye(4), (8, 1, 1))
    found[:, :3] = np.random.default_rng(3).normal(size=(8, 3, 4))
    found[:, :3, 0] *= np.where(np.linalg.det(found[:, :3, :3]) > 0, 1, -1)[:, None]
    found[4:, :3, 0] *= -1
    return found


def test_products_points_and_determinants(matrices: np.ndarray) -> None:
    rows = affine_rows.gather(matrices, np.arange(8))
    turned = affine_rows.gather(matrices, np.arange(8)[::-1])
    expected = matrices @ matrices[::-1]
    np.testing.assert_allclose(affine_rows.compose(rows, turned), affine_rows.gather(expected, np.arange(8)))
    points = np.random.default_rng(4).normal(size=(3, 8))
    moved = np.einsum("kij,jk->ik", matrices[:, :3, :3], points) + matrices[:, :3, 3].T
    np.testing.assert_allclose(affine_rows.transform(rows, points), moved)
    np.testing.assert_allclose(
        affine_rows.determinant(affine_rows.linear(rows)), np.linalg.det(matrices[:, :3, :3]), atol=1e-12
    )


def test_rotations_are_those_of_the_polar_decomposition(matrices: np.ndarray) -> None:
    straight = matrices[:4].copy()
    straight[:, :3, :3] = Rotation.random(4, random_state=5).as_matrix() * [2.0, 0.5, 3.0]
    both = np.concatenate([matrices, straight])
    rotation, size, right = affine_rows.rotation_and_size(affine_rows.gather(both, np.arange(12)))
    assert right.tolist() == [False] * 8 + [True] * 4
    np.testing.assert_allclose(size.T, np.linalg.norm(both[:, :3, :3], axis=1))
    for column, matrix in zip(rotation.T, both, strict=True):
        orthogonal = polar(matrix[:3, :3])[0]
        expected = orthogonal if np.linalg.det(orthogonal) > 0 else -orthogonal
        np.testing.assert_allclose(column.reshape(3, 3).T, expected, atol=1e-9)


def test_angles_between_rotations() -> None:
    one, two = Rotation.random(50, random_state=1), Rotation.random(50, random_state=2)
    columns = [r.as_matrix().transpose(0, 2, 1).reshape(-1, 9).T for r in (one, two)]
    np.testing.assert_allclose(affine_rows.turn_between(*columns), (one * two.inv()).magnitude(), atol=1e-12)
