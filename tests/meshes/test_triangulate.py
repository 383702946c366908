"""Polygons are cut into triangles that lie inside, whatever their shape, plane and turn."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.meshes import triangulate
from unisg_blender.meshes.triangulate import area_vectors, clip_ears, inner_triangles
from unisg_blender.scene import mesh_from_faces
from unisg_blender.scene.mesh import Mesh

COMB = [(0, 0), (5, 0), (5, 3), (4, 3), (4, 1), (3, 1), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]
ARROW = [(0, 0), (2, 1), (0, 2), (0.5, 1)]


def area(ring: np.ndarray) -> float:
    """Signed, of a ring (K, 2): counter-clockwise is positive."""
    x, y = ring.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def inside(ring: np.ndarray, point: np.ndarray) -> bool:
    """By the angle that the ring goes round a point."""
    to = (ring - point) @ np.array([1, 1j])
    return bool(abs(np.angle(np.roll(to, -1) / to).sum()) > np.pi)


def in_space(ring: np.ndarray, plane: int, flipped: bool) -> np.ndarray:
    """A ring in one of three planes, seen from either side."""
    points = np.zeros((len(ring), 3))
    points[:, [(plane + 1) % 3, (plane + 2) % 3]] = ring
    points[:, plane] = 0.3 * ring[:, 0] - 0.2 * ring[:, 1] + 4.0
    return points[::-1] if flipped else points


def check_cut(ring: np.ndarray, plane: int, flipped: bool) -> None:
    points = in_space(ring, plane, flipped)
    numbers = np.arange(len(ring))[::-1].copy()  # the corners stand in another order than the points
    triangles = clip_ears(points[::-1], numbers)
    assert triangles.shape == (len(ring) - 2, 3)
    flat = points[::-1][:, [(plane + 1) % 3, (plane + 2) % 3]]
    own = [area(flat[triangle]) for triangle in triangles]
    whole = area(points[:, [(plane + 1) % 3, (plane + 2) % 3]])
    assert sum(own) == pytest.approx(whole)
    assert min(value * np.sign(whole) for value in own) > 0
    for triangle in triangles:
        assert inside(flat[numbers], flat[triangle].mean(axis=0))


@pytest.mark.parametrize("flipped", [False, True])
@pytest.mark.parametrize("plane", [0, 1, 2])
@pytest.mark.parametrize("shape", [COMB, ARROW], ids=["comb", "arrow"])
def test_concave_polygons(shape: list[tuple[float, float]], plane: int, flipped: bool) -> None:
    for first in range(len(shape)):
        check_cut(np.roll(np.array(shape, float), first, axis=0), plane, flipped)


@given(st.lists(st.floats(0.2, 2.0), min_size=4, max_size=14), st.integers(0, 2), st.booleans())
@settings(max_examples=40)
def test_stars_of_any_kind(reach: list[float], plane: int, flipped: bool) -> None:
    turn = 2 * np.pi * (np.arange(len(reach)) + 0.3) / len(reach)
    check_cut(np.stack([np.cos(turn), np.sin(turn)], axis=1) * np.array(reach)[:, None], plane, flipped)


def mesh_of(rings: list[np.ndarray]) -> Mesh:
    starts = np.cumsum([0, *(len(ring) for ring in rings)])
    faces = [list(range(start, start + len(ring))) for start, ring in zip(starts[:-1], rings, strict=True)]
    return mesh_from_faces("rings", np.concatenate(rings), faces)


@pytest.mark.parametrize("chunk", [1, 2, 250_000])
def test_only_concave_faces_are_cut_anew_and_all_ground_is_covered_once(
    chunk: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(triangulate, "CHUNK", chunk)
    square, triangle = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)]), np.array([(0, 0), (1, 0), (0, 1.0)])
    rings = [
        in_space(np.array(ring, float) + 10 * k, 2, False) for k, ring in enumerate([square, COMB, triangle, ARROW])
    ]
    mesh = mesh_of(rings)
    found = inner_triangles(mesh)
    assert len(found) == len(mesh.triangles)
    vectors = area_vectors(mesh.points, found)
    assert (vectors[:, 2] > 0).all()
    assert vectors[:, 2].sum() / 2 == pytest.approx(1 + area(np.array(COMB)) + 0.5 + area(np.array(ARROW, float)))
    fans = {tuple(row) for row in mesh.triangles.tolist()}
    kept = {tuple(row) for row in found.tolist() if max(row) < 4 or 16 <= min(row) < 19}
    assert kept == {row for row in fans if max(row) < 4 or 16 <= min(row) < 19}


def test_a_face_with_very_many_corners_keeps_its_fan(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = mesh_of([in_space(np.array(COMB, float), 2, False)])
    monkeypatch.setattr(triangulate, "LONGEST_CLIPPED", len(COMB) - 1)
    np.testing.assert_array_equal(inner_triangles(mesh), mesh.triangles)
    monkeypatch.setattr(triangulate, "LONGEST_CLIPPED", len(COMB))
    assert not np.array_equal(inner_triangles(mesh), mesh.triangles)


def test_points_that_are_no_numbers_take_their_triangles_along() -> None:
    square = in_space(np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)]), 2, False)
    mesh = mesh_of([square, square + 5])
    points = mesh.points.copy()
    points[6] = np.nan
    found = inner_triangles(Mesh("broken", points, mesh.corners, mesh.offsets))
    assert sorted(found[:, 0].tolist()) == [0, 0]


def test_what_crosses_itself_or_is_doubled_still_gives_its_triangles() -> None:
    bow = in_space(np.array([(0, 0), (1, 1), (1, 0), (0, 1.0)]), 2, False)
    assert clip_ears(bow, np.arange(4)).shape == (2, 3)
    slit = in_space(np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 0.5), (1, 1), (0, 1.0)]), 2, False)
    assert area_vectors(slit, clip_ears(slit, np.arange(7)))[:, 2].sum() / 2 == pytest.approx(2)


def test_area_vectors_are_twice_the_area_along_the_normal() -> None:
    points = np.array([(1, 1, 1), (3, 1, 1), (1, 4, 1), (1, 1, 6.0)])
    found = area_vectors(points, np.array([[0, 1, 2], [0, 2, 1], [0, 2, 3]]))
    np.testing.assert_allclose(found, [[0, 0, 6], [0, 0, -6], [15, 0, 0]])
