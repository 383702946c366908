from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.meshes.decode import signed_volume
from unisg_blender.meshes.isosurface import isosurface
from unisg_blender.meshes.simplify import _best_places, _quadrics, _split, edges_of, with_faces
from unisg_blender.meshes.sphere import sphere_template
from unisg_blender.meshes.triangulate import area_vectors

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


def sheet(size: float) -> tuple[np.ndarray, np.ndarray]:
    """A square of two triangles, twice over: a flat region with edges of two lengths."""
    points = size * np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0.0)])
    return points, np.array([(0, 1, 2), (0, 2, 3), (1, 4, 5), (1, 5, 2)])


def test_in_flat_regions_short_edges_go_first_to_their_middles() -> None:
    edges, costs = np.array([[1, 2], [0, 2], [1, 5]]), []
    for size in (1.0, 2.0):
        points, triangles = sheet(size)
        place, cost = _best_places(points, _quadrics(points, triangles), edges)
        np.testing.assert_allclose(place, points[edges].mean(axis=1), atol=1e-6)
        trace = np.trace(_quadrics(points, triangles)[edges].sum(axis=1)[:, :3, :3], axis1=1, axis2=2)
        length = np.square(points[edges[:, 0]] - points[edges[:, 1]]).sum(axis=1)
        np.testing.assert_allclose(cost, 1e-6 * trace * length)
        costs.append(cost)
    np.testing.assert_allclose(costs[1], 16 * costs[0])  # areas and squared lengths


def test_at_a_corner_the_corner_stays() -> None:
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1.0)])
    triangles = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2)])
    place, cost = _best_places(points, _quadrics(points, triangles), np.array([[0, 1]]))
    np.testing.assert_allclose(place, [[0, 0, 0]], atol=5e-3)
    assert 0 < cost[0] < 1e-2


def test_the_longest_edges_are_split_in_their_middles() -> None:
    points, triangles = sheet(1.0)
    points = points * (1.0, 1.0, 1.0)
    points[[4, 5], 0] = 4.0  # the right half is three wide
    found, more = _split(points, triangles, 1)
    np.testing.assert_allclose(found[6:], [(points[1] + points[5]) / 2])
    assert len(more) == 6
    areas = area_vectors(found, more)
    assert (areas[:, 2] > 0).all()
    assert areas[:, 2].sum() == pytest.approx(2 * 4)
    both, all_of_it = _split(points, triangles, 9)
    assert sorted(both[6:, 0].tolist()) == [0.5, 2.5]
    assert len(all_of_it) == 8
