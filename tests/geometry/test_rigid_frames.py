"""Rigid poses seen from one another."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from unisg_blender.geometry.rigid_frames import relative_poses


def test_relative_poses_are_those_of_matrices() -> None:
    rng = np.random.default_rng(1)
    poses = np.tile(np.eye(4), (6, 1, 1))
    poses[:, :3, :3] = Rotation.random(6, random_state=2).as_matrix()
    poses[:, :3, 3] = rng.normal(size=(6, 3))
    pairs = np.array([[0, 1], [4, 2], [3, 3]])
    np.testing.assert_allclose(
        relative_poses(poses, pairs), np.linalg.inv(poses[pairs[:, 0]]) @ poses[pairs[:, 1]], atol=1e-12
    )
