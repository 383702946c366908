from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.meshes.decode import signed_volume
from unisg_blender.meshes.isosurface import isosurface

from .shapes import is_closed_and_oriented


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**31))
def test_any_function_gives_a_closed_oriented_surface(seed: int) -> None:
    values = np.random.default_rng(seed).choice([-1.0, -0.3, 0.0, 0.4, 1.0], (6, 7, 5))
    points, triangles = isosurface(values)
    if (values[1:-1, 1:-1, 1:-1] < 0).any():
        assert is_closed_and_oriented(triangles)
        assert signed_volume(points, triangles) > 0


def test_sphere_has_its_volume() -> None:
    grid = np.stack(np.meshgrid(*[np.arange(40) - 19.5] * 3, indexing="ij"))
    points, triangles = isosurface(np.linalg.norm(grid, axis=0) - 15)
    assert np.abs(np.linalg.norm(points - 19.5, axis=1) - 15).max() < 0.05
    assert abs(signed_volume(points, triangles) / (4 / 3 * np.pi * 15**3) - 1) < 0.01


def test_nothing_inside_gives_nothing() -> None:
    points, triangles = isosurface(np.ones((4, 4, 4)))
    assert points.shape == (0, 3)
    assert triangles.shape == (0, 3)
