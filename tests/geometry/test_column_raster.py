"""Columns, slices, lines of cells and what is seen from a point, each beside a plain way to say it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.geometry import column_raster
from unisg_blender.geometry.column_raster import Grid, cells_on, columns, enclosure, slice_at
from unisg_blender.geometry.surface_contact import heights

GRID = Grid((-1.3, 0.4), 0.25, (9, 13))


def test_cells_are_numbered_along_y_first() -> None:
    cells = np.arange(GRID.size)
    middles = GRID.middles_of(cells)
    np.testing.assert_allclose(middles[[0, 1, 13]], [[-1.175, 0.525], [-1.175, 0.775], [-0.925, 0.525]])
    assert GRID.at(middles).tolist() == cells.tolist()
    assert GRID.at(middles + 0.1249).tolist() == cells.tolist()
    assert (GRID.at(middles.min(axis=0) + np.array([[-0.13, 0], [0, -0.13]])) == -1).all()
    assert (GRID.at(middles.max(axis=0) + np.array([[0.13, 0], [0, 0.13]])) == -1).all()
    mask = GRID.mask(np.array([0, 14]))
    assert mask.shape == GRID.shape
    assert np.argwhere(mask).tolist() == [[0, 0], [1, 1]]
    part = GRID.window((2, 5), (3, 4))
    np.testing.assert_allclose(part.middles_of(np.array([0])), GRID.middles_of(np.array([2 * 13 + 5])))


@given(st.floats(-5, 5), st.floats(-5, 5), st.floats(0.1, 4), st.floats(0.1, 4), st.integers(0, 3))
def test_a_grid_around_a_rectangle_has_its_margin_on_all_sides(
    x: float, y: float, w: float, d: float, margin: int
) -> None:
    low = np.array([x, y])
    grid = Grid.around(low, np.add(low, (w, d)), 0.25, margin)
    np.testing.assert_allclose(low - grid.origin, margin * 0.25)
    beyond = np.array(grid.origin) + 0.25 * np.array(grid.shape) - (np.add(low, (w, d)))
    assert ((beyond >= margin * 0.25 - 1e-9) & (beyond < (margin + 1) * 0.25 + 1e-9)).all()


@pytest.mark.parametrize("at_once", [7, 2_000_000])
@given(st.integers(0, 10**6))
@settings(max_examples=25)
def test_columns_are_where_vertical_lines_meet_triangles(at_once: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    triangles = rng.normal(size=(12, 3, 3)) * rng.uniform(0.1, 2) + (-0.2, 2.0, 0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(column_raster, "AT_ONCE", at_once)
        found = columns(triangles, GRID)
    expected = heights(GRID.middles_of(np.arange(GRID.size)), triangles)
    cell, triangle = np.nonzero(np.isfinite(expected))
    assert sorted(zip(found.cell.tolist(), found.triangle.tolist(), strict=True)) == list(
        zip(cell.tolist(), triangle.tolist(), strict=True)
    )
    np.testing.assert_allclose(found.height, expected[found.cell, found.triangle], atol=1e-6)
    same = np.diff(found.cell) == 0
    assert (np.diff(found.cell) >= 0).all()
    assert (np.diff(found.height)[same] >= -column_raster.ALIKE).all()
    some = found.take(found.height > 0)
    assert len(some.cell) == int((found.height > 0).sum()) == len(some.triangle)


def test_walls_cover_no_column() -> None:
    upright = np.array([[(0, 0, 0), (0, 5, 0), (0, 5, 3)]], float)
    assert not len(columns(upright, GRID).cell)
    assert not len(columns(np.zeros((0, 3, 3)), GRID).cell)


@given(st.integers(0, 10**6))
@settings(max_examples=30)
def test_a_slice_ends_where_edges_cross_the_plane(seed: int) -> None:
    triangles = np.random.default_rng(seed).normal(size=(9, 3, 3))
    above = triangles[:, :, 2] > 0.1
    crossing = triangles[above.any(axis=1) & ~above.all(axis=1)]
    found = slice_at(crossing, 0.1)
    for ends, triangle in zip(found, crossing, strict=True):
        expected = []
        for a, b in ((0, 1), (1, 2), (2, 0)):
            low, high = triangle[a], triangle[b]
            if (low[2] > 0.1) != (high[2] > 0.1):
                share = (0.1 - low[2]) / (high[2] - low[2])
                expected.append(low[:2] + share * (high - low)[:2])
        assert len(expected) == 2
        assert np.abs(np.sort(ends, axis=0) - np.sort(expected, axis=0)).max() < 1e-9


def test_cells_on_lines_are_those_that_they_run_through() -> None:
    segments = np.array([[(-1.2, 0.5), (0.9, 3.5)], [(0, 1), (0, 1)], [(-9, 1), (9, 1)]], float)
    cell, entry = cells_on(segments, GRID)
    for number, (start, stop) in enumerate(segments):
        mine = np.unique(cell[entry == number])
        points = start + np.linspace(0, 1, 5000)[:, None] * (stop - start)
        through = GRID.at(points)
        assert set(mine) <= set(through[through >= 0])
        place = np.stack(np.divmod(mine, GRID.shape[1]), axis=1)
        place = place[np.argsort((GRID.middles_of(mine) - start) @ (stop - start))]
        assert np.abs(np.diff(place, axis=0)).max(initial=0) <= 1
    assert len(np.unique(cell[entry == 2])) == GRID.shape[0]
    assert len(np.unique(cell[entry == 1])) == 1


def ring(radius: float, degrees: tuple[float, float] = (0, 360)) -> np.ndarray:
    """An arc around the origin, in pieces."""
    angle = np.radians(np.linspace(*degrees, 200))
    points = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.stack([points[:-1], points[1:]], axis=1)


@pytest.mark.parametrize(
    ("degrees", "directions", "seen"),
    [
        ((0, 360), 16, 16),
        ((-5, 185), 16, 9),
        ((80, 100), 16, 1),
        ((40, 140), 8, 3),
        ((-140, -40), 8, 3),
        ((0, 360), 4, 4),
    ],
)
def test_directions_in_which_something_is_seen(degrees: tuple[float, float], directions: int, seen: int) -> None:
    walls, middle = ring(2.0, degrees), np.zeros((1, 2))
    assert enclosure(walls, middle, 0.05, np.array([9.0]), directions).tolist() == [seen]
    assert enclosure(walls, middle, 0.05, np.array([1.9]), directions).tolist() == [0]
    assert enclosure(walls, middle, 0.05, np.array([2.2]), directions).tolist() == [seen]


def test_points_see_what_is_around_themselves() -> None:
    walls = ring(2.0) + np.array([10.0, 0])
    points = np.array([[10.0, 0], [0.0, 0], [10.5, -0.5]])
    found = enclosure(walls, points, 0.05, np.full(3, 5.0))
    assert (found[0], found[1], found[2]) == (16, 0, 16)
    assert enclosure(walls, points, 0.05, np.full(3, 50.0))[1] in (1, 2, 3)  # far away, in one direction or so
    assert enclosure(np.zeros((0, 2, 2)), points, 0.05, np.full(3, 5.0)).tolist() == [0, 0, 0]
    assert not enclosure(walls, points[:0], 0.05, np.zeros(0)).size
