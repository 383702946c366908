"""Heights and gaps of triangles, beside scipy's interpolation and trimesh's nearest points."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import LinearNDInterpolator
from trimesh.triangles import closest_point

from unisg_blender.geometry.surface_contact import (
    bearing,
    column_ends,
    contact_heights,
    grid_places,
    heights,
    looks_up,
    surface_gap,
    walls_around,
    within,
)


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


@pytest.mark.slow
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


SQUARE = np.array([[(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 0, 0), (1, 1, 0), (0, 1, 0)]], float)
EVERYWHERE = np.array([-9.0, -9, -9]), np.array([9.0, 9, 9])


def at(x: float, y: float, z: float, triangles: np.ndarray = SQUARE, size: float = 1.0) -> np.ndarray:
    """A surface elsewhere, scaled."""
    return triangles * size + (x, y, z)


def cube(x: float = 0, y: float = 0, z: float = 0, size: float = 1.0) -> np.ndarray:
    """A closed box whose faces look outwards, its lowest corner at a place."""
    faces = [SQUARE[:, ::-1], np.add(SQUARE, (0, 0, 1))]
    for turn in ([2, 0, 1], [1, 2, 0]):
        faces += [SQUARE[:, ::-1][..., turn], np.add(SQUARE, (0, 0, 1))[..., turn]]
    return np.concatenate(faces) * size + (x, y, z)


def test_the_cube_of_these_tests_is_closed_and_looks_outwards() -> None:
    found = cube()
    normal = np.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0])
    assert (((found.mean(axis=1) - 0.5) * normal).sum(axis=1) > 0).all()
    assert np.einsum("mi,mi->", found[:, 0], normal) / 6 == pytest.approx(1)


@pytest.mark.parametrize(
    ("rise", "rests"),
    [(0.0, True), (0.0049, True), (0.0051, False), (-0.0099, True), (-0.0101, False)],
)
def test_what_stands_within_the_gap_and_the_overlap_rests(rise: float, rests: bool) -> None:
    found = contact_heights(cube(0.2, 0.2, 1 + rise, 0.5), cube(), *EVERYWHERE, 0.005, 0.01)
    assert bool(len(found)) == rests
    if rests:
        np.testing.assert_allclose(found, 1)


def test_boxes_beside_each_other_and_below_do_not_rest() -> None:
    assert not len(contact_heights(cube(1.01, 0, 1), cube(), *EVERYWHERE, 0.005, 0.01))
    assert not len(contact_heights(cube(0, 0, -1), cube(), *EVERYWHERE, 0.005, 0.01))
    assert not len(contact_heights(cube(0, 0, 1), cube(), np.array([2.0, 2, -9]), np.array([3.0, 3, 9]), 0.005, 0.01))


@pytest.mark.parametrize("inside_out", [(False, False), (True, False), (False, True), (True, True)])
def test_meshes_may_be_inside_out(inside_out: tuple[bool, bool]) -> None:
    upper, lower = (
        part[:, ::-1] if turned else part for part, turned in zip((cube(0, 0, 1), cube()), inside_out, strict=True)
    )
    np.testing.assert_allclose(contact_heights(upper, lower, *EVERYWHERE, 0.005, 0.01), 1)


@pytest.mark.parametrize("upward", [True, False])
def test_sheets_bear_whichever_side_is_theirs(upward: bool) -> None:
    sheet = at(0, 0, 1) if upward else at(0, 0, 1)[:, ::-1]
    np.testing.assert_allclose(contact_heights(cube(0.1, 0.1, 1, 0.5), sheet, *EVERYWHERE, 0.005, 0.01), 1)
    np.testing.assert_allclose(contact_heights(at(0, 0, 1)[:, ::-1], cube(), *EVERYWHERE, 0.005, 0.01), 1)


def test_a_thing_in_a_box_stands_on_its_bottom_and_not_under_its_lid() -> None:
    box = np.concatenate([cube(0, 0, 0, 2.0), cube(0.1, 0.1, 0.1, 1.8)[:, ::-1]])  # walls of a decimetre
    np.testing.assert_allclose(contact_heights(cube(0.5, 0.5, 0.1, 1.0), box, *EVERYWHERE, 0.005, 0.01), 0.1)
    assert not len(contact_heights(cube(0.5, 0.5, 0.9, 1.0), box, *EVERYWHERE, 0.005, 0.01))


def test_ends_of_columns() -> None:
    places = np.array([[0.5, 0.4], [5.0, 5.0]])
    (up_low, up_high), (down_low, down_high) = column_ends(places, np.concatenate([cube(), cube(0, 0, 3)]))
    assert (up_low[0], up_high[0], down_low[0], down_high[0]) == (1, 4, 0, 3)
    assert (up_low[1], up_high[1], down_low[1], down_high[1]) == (np.inf, -np.inf, np.inf, -np.inf)
    assert column_ends(np.zeros((0, 2)), cube()).shape == (2, 2, 0)


@pytest.mark.parametrize(("degrees", "bears"), [(0, True), (59, True), (61, False), (90, False), (180, True)])
def test_only_what_is_level_enough_bears(degrees: float, bears: bool) -> None:
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    for turn in ([[1, 0, 0], [0, cos, -sin], [0, sin, cos]], [[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]):
        turned = SQUARE @ np.array(turn).T
        assert len(bearing(turned)) == (2 if bears else 0)
        if degrees != 90:
            assert looks_up(turned).tolist() == [degrees < 90] * 2


def test_the_grid_covers_the_box_evenly() -> None:
    found = grid_places(np.array([1.0, 10, 0]), np.array([3.0, 14, 5]))
    assert found.shape == (64, 2)
    np.testing.assert_allclose(found.mean(axis=0), [2, 12])
    np.testing.assert_allclose(found.min(axis=0), [1 + 2 / 16, 10 + 4 / 16])
    np.testing.assert_allclose(np.unique(np.round(np.diff(np.unique(found[:, 0])), 9)), [0.25])


def test_walls_around_are_measured_along_the_axes_both_ways() -> None:
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    room = (cube(size=4.0) - (1, 1.5, 0.5)) @ turn.T
    found = walls_around(np.zeros(3), room, turn)
    np.testing.assert_allclose(found, [[3, 1], [2.5, 1.5], [3.5, 0.5]])
    assert (walls_around(np.array([9.0, 9, 9]), room, turn) == np.inf).any(axis=1).all()
    np.testing.assert_allclose(walls_around(np.array([0.5, 0.5, 1]), at(0, 0, 3), np.eye(3))[2], [2, np.inf])


def crossing(x: float, y: float) -> np.ndarray:
    """A thin upright blade that is far from its own corners where it cuts the ground at a place."""
    return np.array([[(x, y, 5), (x, y, -5), (x + 1e-3, y, 5.0)]])


@pytest.mark.parametrize(
    ("place", "through"),
    [((2.0, 1.0), True), ((1.0, 3.0), True), ((-0.5, 2.0), False), ((2.0, -0.5), False), ((4.0, 4.0), False)],
)
def test_an_edge_through_a_face_leaves_no_gap(place: tuple[float, float], through: bool) -> None:
    ground = np.array([[(0, 0, 0), (6, 0, 0), (0, 6, 0.0)]])
    for first, second in ((ground, crossing(*place)), (crossing(*place), ground)):
        assert (surface_gap(first, second) == 0) == through
    above = np.add(crossing(*place), (0, 0, 6))
    assert surface_gap(ground, above) >= 1 - 1e-9


def test_gaps_between_boxes() -> None:
    assert surface_gap(cube(), cube(1.5, 0, 0)) == pytest.approx(0.5)
    assert surface_gap(cube(), cube(1.3, 1.4, 0)) == pytest.approx(0.5)
    assert surface_gap(cube(), cube(0.5, 0.5, 0.5)) == 0
    assert surface_gap(cube(), np.zeros((0, 3, 3))) == np.inf
    assert surface_gap(cube(), np.full((1, 3, 3), [0.5, 0.5, 3.0])) == pytest.approx(2)  # a triangle of no size
