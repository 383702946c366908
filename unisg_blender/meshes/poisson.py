"""The screened Poisson equation on a regular grid: a function that grows along normals and vanishes at points.

Why not Open3D: it weighs hundreds of megabytes and has no wheels for the Python of newer Blenders.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.sparse import csr_matrix

from ..geometry.arrays import Floats
from .isosurface import CORNERS

SMOOTHING = 0.7
"""Standard deviation, in cells, of the blur that spreads the normals."""
SCREENING = 64.0
"""Weight of the function's values at the points, per cell: more than the authors' 4, as furniture is thin."""
ITERATIONS = 16


def solve_screened(place: Floats, normals: Floats, areas: Floats, size: list[int]) -> tuple[Floats, Floats]:
    """Solve for the function of which the oriented points lie on the zero level.

    The function's gradient comes near to the normals, spread over the cells, and
    its values at the points near to 0 (Kazhdan and Hoppe, "Screened Poisson
    Surface Reconstruction", ToG 2013). The gradient's part is solved by Fourier
    transform on the periodic grid; conjugate gradients, preconditioned by it, add the points'.

    Parameters
    ----------
    place
        (n, 3) in cells.
    normals
        (n, 3) of length 1, outwards.
    areas
        (n,) surface that each point stands for, in squared cells.
    size
        Cells along x, y, z.

    Returns
    -------
    The function (X, Y, Z), negative inside, and its values (n,) at the points.
    """
    at = _interpolation(place, size)
    square, right = _right_side(at, normals * areas[:, None], size)
    screen = SCREENING * areas
    small = 1.0 / max(size) ** 2
    spectrum = right / (square + small)
    values = fft.irfftn(spectrum, s=tuple(size)).ravel()
    rest = fft.irfftn(right - square * spectrum, s=tuple(size)).ravel() - at.T @ (screen * (at @ values))
    way, image, before = np.zeros_like(values), np.zeros_like(values), 1.0
    for _ in range(ITERATIONS):
        better = fft.irfftn(fft.rfftn(rest.reshape(size)) / (square + small), s=tuple(size)).ravel()
        now = float(rest @ better)
        if not now > 0:
            break
        share = now / before if way.any() else 0.0
        way = better + share * way
        image = rest - small * better + at.T @ (screen * (at @ better)) + share * image
        step = now / float(way @ image)
        values, rest, before = values + step * way, rest - step * image, now
    return values.reshape(size), at @ values


def _interpolation(place: Floats, size: list[int]) -> csr_matrix:
    """(n, X Y Z): the trilinear weights of the eight grid points around each place (n, 3)."""
    base = np.floor(place).astype(np.int64)
    part = (place - base)[:, None]
    weights = np.where(CORNERS, part, 1 - part).prod(axis=2)
    cells = np.ravel_multi_index(tuple(np.moveaxis(base[:, None] + CORNERS, 2, 0)), size)
    starts = np.arange(len(place) + 1) * len(CORNERS)
    return csr_matrix((weights.ravel(), cells.ravel(), starts), shape=(len(place), int(np.prod(size))))


def _right_side(at: csr_matrix, vectors: Floats, size: list[int]) -> tuple[Floats, NDArray[np.complex128]]:
    """Squared frequencies, and the spectrum of minus the divergence of the vectors (n, 3), spread and blurred."""
    frequencies = (fft.fftfreq(size[0]), fft.fftfreq(size[1]), fft.rfftfreq(size[2]))
    waves = np.meshgrid(*(2 * np.pi * f for f in frequencies), indexing="ij", sparse=True)
    square = waves[0] ** 2 + waves[1] ** 2 + waves[2] ** 2
    right = np.zeros(square.shape, complex)
    for axis, wave in enumerate(waves):
        right -= 1j * wave * fft.rfftn((at.T @ vectors[:, axis]).reshape(size))
    return square, right * np.exp(-square * SMOOTHING**2 / 2)
