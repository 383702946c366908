"""Polygons beside plain ways to say the same: sums over triangles, angles around points, dense samples of edges."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from unisg_blender.geometry.planar import (
    footprint_gap,
    footprints,
    outside_rectangle,
    rectangle_gap,
    rotate,
    rotate_by,
    turned_reach,
)
from unisg_blender.geometry.polygon import (
    area,
    convex_gap,
    convex_hull,
    inside,
    least_rectangle,
    next_corners,
    outside_distance,
    to_edges,
    without_straight_corners,
)

L_SHAPE = np.array([[0, 0], [6, 0], [6, 3], [3, 3], [3, 5], [0, 5]], float)
SEEDS = st.integers(0, 10**6)


def star(seed: int) -> np.ndarray:
    """A polygon of any shape that does not cross itself, somewhere, counter-clockwise."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 10))
    angle = (np.arange(count) + rng.uniform(0, 0.9, count)) * 2 * np.pi / count
    return (
        rng.uniform(0.3, 2, count)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1) + rng.normal(size=2) * 3
    )


def along_edges(polygon: np.ndarray, count: int = 400) -> np.ndarray:
    share = np.linspace(0, 1, count)[:, None]
    return np.concatenate([a + share * (b - a) for a, b in zip(polygon, next_corners(polygon), strict=True)])


@given(SEEDS)
def test_areas_are_sums_of_triangles(seed: int) -> None:
    polygon = star(seed)
    x, y = (polygon[1:-1] - polygon[0]).T, (polygon[2:] - polygon[0]).T
    expected = (x[0] * y[1] - x[1] * y[0]).sum() / 2
    assert area(polygon) == pytest.approx(expected)
    assert area(polygon[::-1]) == pytest.approx(-expected)


@given(SEEDS)
@settings(max_examples=40)
def test_what_is_inside_is_gone_round_and_outside_is_as_far_as_the_edges(seed: int) -> None:
    polygon = star(seed)
    points = np.random.default_rng(seed + 1).uniform(-3, 3, (40, 2)) + polygon.mean(axis=0)
    edges = along_edges(polygon)
    far = np.linalg.norm(points[:, None] - edges, axis=2).min(axis=1)
    clear = far > 0.02
    to = (polygon[None] - points[:, None]) @ np.array([1, 1j])
    round_it = np.abs(np.angle(np.roll(to, -1, axis=1) / to).sum(axis=1)) > np.pi
    assert (inside(polygon, points) == round_it)[clear].all()
    np.testing.assert_allclose(outside_distance(polygon, points)[clear], np.where(round_it, 0, far)[clear], atol=0.01)
    ways = to_edges(polygon, points)
    assert ways.shape == (40, len(polygon), 2)
    ends = points[:, None] + ways
    off = np.linalg.norm(ends[:, :, None] - edges, axis=3).min(axis=2)
    assert off.max() < 0.01
    np.testing.assert_allclose(np.linalg.norm(ways, axis=2).min(axis=1), far, atol=0.01)


@given(SEEDS)
@settings(max_examples=40)
def test_hulls_and_least_rectangles_hold_all_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(12, 2)) * rng.uniform(0.1, 3, 2) @ np.array([[0.8, 0.6], [-0.6, 0.8]]) + rng.normal(
        size=2
    )
    hull = convex_hull(points)
    edge, after = next_corners(hull) - hull, np.roll(next_corners(hull), -1, axis=0) - next_corners(hull)
    assert (edge[:, 0] * after[:, 1] - edge[:, 1] * after[:, 0] > 0).all()
    assert outside_distance(hull, points).max() < 1e-9
    middle, half, turn = least_rectangle(points)
    cos, sin = np.cos(turn), np.sin(turn)
    seen = (points - middle) @ np.array([[cos, -sin], [sin, cos]])
    np.testing.assert_allclose(np.abs(seen).max(axis=0), half, atol=1e-9)
    np.testing.assert_allclose(seen.max(axis=0), -seen.min(axis=0), atol=1e-9)
    for other in np.linspace(0, np.pi / 2, 90):
        around = np.ptp(points @ np.array([[np.cos(other), -np.sin(other)], [np.sin(other), np.cos(other)]]), axis=0)
        assert 4 * half.prod() <= around.prod() + 1e-9


def test_hulls_without_area() -> None:
    assert convex_hull(np.array([[0, 0], [1, 1], [0, 0.0]])).tolist() == [[0, 0], [1, 1]]
    assert convex_hull(np.array([[0, 0], [1, 1], [2, 2], [3, 3.0]])).tolist() == [[0, 0], [3, 3]]


@given(SEEDS)
@settings(max_examples=40)
def test_gaps_between_convex_polygons(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, second = (convex_hull(rng.normal(size=(6, 2)) + rng.normal(size=2) * 2) for _ in range(2))
    near = np.linalg.norm(along_edges(first, 60)[:, None] - along_edges(second, 60), axis=2).min()
    if inside(first, along_edges(second, 60)).any() or inside(second, along_edges(first, 60)).any():
        assert convex_gap(first, second) == 0
    else:
        assert convex_gap(first, second) == pytest.approx(near, abs=0.1)
        assert convex_gap(first, second) == convex_gap(second, first)


def test_corners_on_straight_edges_are_left_out() -> None:
    more = np.concatenate(
        [[corner, (corner + after) / 2] for corner, after in zip(L_SHAPE, next_corners(L_SHAPE), strict=True)]
    )
    np.testing.assert_allclose(without_straight_corners(more), L_SHAPE)
    bent = more.copy()
    bent[1, 1] += 0.01
    assert len(without_straight_corners(bent)) == 7
    assert len(without_straight_corners(bent, 0.1)) == 6
    line = np.array([[0, 0], [1, 0], [2, 0.0]])
    np.testing.assert_array_equal(without_straight_corners(line), line)


def corners(middle: np.ndarray, half: np.ndarray, yaw: float) -> np.ndarray:
    along, across = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    return np.array(
        [middle + i * half[0] * along + j * half[1] * across for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    )


@given(SEEDS)
@settings(max_examples=40)
def test_rectangles(seed: int) -> None:
    rng = np.random.default_rng(seed)
    middle, half, yaw = rng.normal(size=(2, 2)), rng.uniform(0.1, 1, (2, 2)), rng.uniform(-4, 4, 2)
    first, second = (corners(middle[k], half[k], yaw[k]) for k in range(2))
    found = footprints(half[0], np.column_stack([middle, np.zeros(2), yaw]))
    assert area(found[0]) == pytest.approx(4 * half[0].prod())
    np.testing.assert_allclose(np.sort(found[0], axis=0), np.sort(first, axis=0), atol=1e-9)
    point = rng.normal(size=2)
    expected = outside_distance(first, point)
    assert outside_rectangle(point - middle[0], yaw[0], half[0]) == pytest.approx(float(expected), abs=1e-9)
    seen = rotate(first - middle[0], -0.7)
    np.testing.assert_allclose(np.abs(seen).max(axis=0), turned_reach(half[0], yaw[0] - 0.7), atol=1e-9)
    gap = rectangle_gap(middle[1] - middle[0], yaw[0], half[0], yaw[1], half[1])
    true = convex_gap(first, second)
    assert (gap < 0) == (true == 0) or abs(gap) < 1e-9
    assume(true > 0)
    assert gap <= true + 1e-9


@given(SEEDS)
def test_points_turn_against_the_clock(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, angle = rng.normal(size=(5, 2)), rng.uniform(-7, 7, 5)
    expected = (points @ np.array([1, 1j])) * np.exp(1j * angle)
    np.testing.assert_allclose(rotate(points, angle) @ np.array([1, 1j]), expected, atol=1e-9)
    np.testing.assert_allclose(rotate_by(points, np.cos(angle), np.sin(angle)) @ np.array([1, 1j]), expected, atol=1e-9)


def test_gaps_of_footprints_are_those_of_their_rectangles() -> None:
    center, half, other = np.array([1.0, 2, 0]), np.array([1, 0.5, 1]), np.array([0.5, 0.4, 1])
    places = np.array([[4, 3, 0, 1.0], [1.2, 2, 0, 0], [1, 5, 0, 2.0]])
    found = footprint_gap(center, half, 0.4, places, other)
    first = corners(center[:2], half, 0.4)
    for gap, place in zip(found, places, strict=True):
        apart = convex_gap(first, corners(place[:2], other, place[3]))
        assert (gap < 0) == (apart == 0)
        assert gap <= apart + 1e-9
