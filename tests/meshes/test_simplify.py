from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.meshes.decode import signed_volume
from unisg_blender.meshes.isosurface import isosurface
from unisg_blender.meshes.simplify import edges_of, with_faces
from unisg_blender.meshes.sphere import sphere_template

from .shapes import is_closed_and_oriented


def ring() -> tuple[np.ndarray, np.ndarray]:
    """A torus of marching tetrahedra."""
    x, y, z = np.meshgrid(*[np.linspace(-1.5, 1.5, 31)] * 3, indexing="ij")
    return isosurface((np.hypot(x, y) - 1) ** 2 + z**2 - 0.2)


@settings(deadline=None, max_examples=15)
@given(st.integers(4, 1500))
def test_a_sphere_with_any_number_of_faces(faces: int) -> None:
    points, triangles = with_faces(*sphere_template(600), faces)
    assert len(triangles) == faces + faces % 2
    assert len(points) == len(triangles) // 2 + 2
    assert is_closed_and_oriented(triangles)
    assert signed_volume(points, triangles) > 0


@pytest.mark.slow
@pytest.mark.parametrize("faces", [5000, 500, 60])
def test_a_ring_stays_a_ring(faces: int) -> None:
    points, triangles = ring()
    found, simple = with_faces(points, triangles, faces)
    assert len(simple) == faces
    assert len(found) == faces // 2  # Euler characteristic 0: one handle
    assert is_closed_and_oriented(simple)
    assert signed_volume(found, simple) == pytest.approx(signed_volume(points, triangles), rel=0.01 * 5000 / faces)


@pytest.mark.slow
def test_what_cannot_be_simplified_keeps_its_faces() -> None:
    _, simple = with_faces(*ring(), 4)
    assert 14 <= len(simple) < 60
    assert is_closed_and_oriented(simple)


def test_edges_and_what_lies_opposite() -> None:
    edges, opposite = edges_of(np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]))
    assert edges.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    assert [set(pair) for pair in opposite.tolist()] == [{2, 3}, {1, 3}, {1, 2}, {0, 3}, {0, 2}, {0, 1}]
