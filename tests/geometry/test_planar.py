"""Angles and rectangles in the plane."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from unisg_blender.geometry.planar import heading, wrapped


def test_angles_are_wrapped_to_half_turns() -> None:
    angles = np.linspace(-20, 20, 101)
    found = wrapped(angles)
    assert ((found >= -np.pi) & (found < np.pi)).all()
    np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * angles), atol=1e-12)


def test_what_the_heading_leaves_turns_about_a_horizontal_axis() -> None:
    rotations = Rotation.random(50, random_state=7)
    left = Rotation.from_rotvec(np.outer(-heading(rotations.as_matrix()), [0, 0, 1])) * rotations
    np.testing.assert_allclose(left.as_rotvec()[:, 2], 0, atol=1e-9)
