"""The screened Poisson equation: what comes out solves it, and is a ball's distance where a ball's points went in."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import fft

from unisg_blender.meshes.poisson import SCREENING, SMOOTHING, _interpolation, solve_screened

SIZE = [24, 20, 22]
MIDDLE, RADIUS = np.array([11.3, 9.8, 10.6]), 5.5


def ball(count: int = 1500) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places, normals and areas of points spread evenly over a sphere."""
    k = np.arange(count) + 0.5
    z, turn = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    normals = np.stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z], axis=1)
    return MIDDLE + RADIUS * normals, normals, np.full(count, 4 * np.pi * RADIUS**2 / count)


def test_values_between_cells_are_trilinear() -> None:
    rng = np.random.default_rng(0)
    place = rng.uniform(1, 18, (40, 3))
    at = _interpolation(place, SIZE)
    grid = np.stack(np.meshgrid(*map(np.arange, SIZE), indexing="ij"), axis=-1).reshape(-1, 3)
    np.testing.assert_allclose(at @ (1 + grid @ [2.0, -3.0, 0.5]), 1 + place @ [2.0, -3.0, 0.5])
    np.testing.assert_allclose(at.sum(axis=1), 1)
    assert at.toarray().min() >= 0


def test_a_ball_is_negative_inside_and_nothing_on_its_surface() -> None:
    place, normals, areas = ball()
    values, found = solve_screened(place, normals, areas, SIZE)
    assert values.shape == tuple(SIZE)
    grid = np.stack(np.meshgrid(*map(np.arange, SIZE), indexing="ij"), axis=-1)
    away = np.linalg.norm(grid - MIDDLE, axis=-1) - RADIUS
    assert (values[away < -1] < 0).all()
    assert (values[away > 1] > 0).all()
    step = np.ptp(values)
    assert np.abs(found).max() < 0.03 * step
    assert np.abs(found - _interpolation(place, SIZE) @ values.ravel()).max() < 1e-9 * step


def test_what_comes_out_solves_the_equation() -> None:
    place, normals, areas = ball()
    values, _ = solve_screened(place, normals, areas, SIZE)
    at = _interpolation(place, SIZE)
    waves = np.meshgrid(*(2 * np.pi * np.fft.fftfreq(n) for n in SIZE), indexing="ij")
    square = sum(wave**2 for wave in waves)
    blur, right = np.exp(-square * SMOOTHING**2 / 2), np.zeros(SIZE, complex)
    for axis, wave in enumerate(waves):
        spread = (at.T @ (normals[:, axis] * areas)).reshape(SIZE)
        right -= 1j * wave * fft.fftn(spread)
    wanted = fft.ifftn(right * blur).real.ravel()
    left = fft.ifftn(square * fft.fftn(values)).real.ravel() + at.T @ (SCREENING * areas * (at @ values.ravel()))
    assert np.linalg.norm(left - wanted) < 0.05 * np.linalg.norm(wanted)


@pytest.mark.parametrize("factor", [0.5, 3.0])
def test_weights_of_points_count_by_their_area(factor: float) -> None:
    place, normals, areas = ball(600)
    one, _ = solve_screened(place, normals, areas, SIZE)
    two, _ = solve_screened(place, normals, areas * factor, SIZE)
    assert np.ptp(two) != pytest.approx(np.ptp(one), rel=0.01)
