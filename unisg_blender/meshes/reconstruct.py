"""Closed meshes from oriented point clouds: Poisson reconstruction on a regular grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.ndimage import map_coordinates
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..errors import UniSGError
from ..scene.mesh import Mesh, mesh_from_faces
from .isosurface import CORNERS, isosurface

MARGIN = 0.15
"""Empty share of the grid on each side of the points."""
SMOOTHING = 1.0
"""Standard deviation, in cells, of the blur that spreads the normals."""


def reconstruct(
    points: NDArray[np.floating], normals: NDArray[np.floating], resolution: int = 96, name: str = "Reconstructed"
) -> Mesh:
    """A closed, outward-oriented triangle mesh through oriented points.

    The normals are spread into a vector field, whose divergence is that of the
    gradient of the solid's indicator function; a Fourier transform solves for it
    (Kazhdan et al., "Poisson Surface Reconstruction", SGP 2006, on a periodic
    grid), and the level set through the points is the surface.

    Parameters
    ----------
    points
        (n, 3) in any unit, n >= 4.
    normals
        (n, 3) pointing out of the solid, of any length but zero.
    resolution
        Cells along the longest side: between 16 and 256. Walls thinner than about
        two cells close up or vanish.
    name
        Name of the mesh.

    Raises
    ------
    UniSGError
        If there are fewer than 4 points, they are not finite, all at one place,
        or the normals do not enclose a solid.
    """
    points, normals = _checked(points, normals)
    if not 16 <= resolution <= 256:
        raise UniSGError(f"the resolution must be between 16 and 256, not {resolution}")
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    cell = float(np.ptp(points, axis=0).max()) / (resolution * (1 - 2 * MARGIN))
    size = [fft.next_fast_len(int(side)) for side in np.ceil(np.ptp(points, axis=0) / cell + 2 * MARGIN * resolution)]
    shift = (np.array(size) - 1) / 2 - middle / cell
    place = points / cell + shift
    weights = _areas(place)
    indicator = _solve(_spread(place, normals * weights[:, None], size))
    level = np.average(map_coordinates(indicator, place.T, order=1), weights=weights)
    found, triangles = isosurface(indicator - level)
    triangles = _near(found, triangles, place)
    if not len(triangles):
        raise UniSGError("the points enclose no solid: check that the normals all point outwards")
    used, faces = np.unique(triangles, return_inverse=True)
    return mesh_from_faces(name, (found[used] - shift) * cell, faces.reshape(-1, 3))


def _checked(
    points: NDArray[np.floating], normals: NDArray[np.floating]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    points, normals = np.asarray(points, np.float64), np.asarray(normals, np.float64)
    if points.shape != normals.shape or points.ndim != 2 or points.shape[1] != 3 or len(points) < 4:
        raise UniSGError(f"needs 4 or more points with a normal each, got shapes {points.shape} and {normals.shape}")
    if not (np.isfinite(points).all() and np.isfinite(normals).all()):
        raise UniSGError("points and normals must be finite numbers")
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    if not (length > 0).all() or not np.ptp(points, axis=0).max() > 0:
        raise UniSGError("points must not all lie at one place, and normals must not be zero")
    return points, normals / length


def _areas(place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Surface that each point stands for, from the distance to its fourth neighbour; up to a common factor."""
    neighbours = min(5, len(place))
    distance = np.asarray(cKDTree(place).query(place, neighbours)[0])[:, -1]
    return np.square(np.maximum(distance, 1e-6))


def _spread(place: NDArray[np.float64], vectors: NDArray[np.float64], size: list[int]) -> NDArray[np.float64]:
    """The vectors (n, 3) on a grid (3, X, Y, Z), each shared out to the eight corners around its place."""
    base = np.floor(place).astype(np.int64)
    part = place - base
    field = np.zeros((3, int(np.prod(size))))
    for corner in CORNERS:
        share = np.prod(np.where(corner, part, 1 - part), axis=1)
        flat = np.ravel_multi_index(tuple((base + corner).T), size)
        for axis in range(3):
            field[axis] += np.bincount(flat, share * vectors[:, axis], field.shape[1])
    return field.reshape(3, *size)


def _solve(field: NDArray[np.float64]) -> NDArray[np.float64]:
    """The function (X, Y, Z) whose gradient comes nearest to a blurred vector field; it grows along the field."""
    shape = field.shape[1:]
    frequencies = (fft.fftfreq(shape[0]), fft.fftfreq(shape[1]), fft.rfftfreq(shape[2]))
    x, y, z = np.meshgrid(*(2 * np.pi * f for f in frequencies), indexing="ij", sparse=True)
    square = x * x + y * y + z * z
    square[0, 0, 0] = 1.0
    transforms = fft.rfftn(field, axes=(1, 2, 3))
    divergence = 1j * (x * transforms[0] + y * transforms[1] + z * transforms[2])
    spectrum = -divergence / square * np.exp(-square * SMOOTHING**2 / 2)
    spectrum[0, 0, 0] = 0
    return np.asarray(fft.irfftn(spectrum, s=shape), np.float64)


def _near(points: NDArray[np.float64], triangles: NDArray[np.int64], place: NDArray[np.float64]) -> NDArray[np.int64]:
    """The triangles of those connected parts that come within two cells of a given point."""
    if not len(triangles):
        return triangles
    pairs = triangles[:, [0, 1, 1, 2]].reshape(-1, 2)
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points), len(points)))
    _, part = connected_components(graph, directed=False)
    touched = np.zeros(part.max() + 1, bool)
    touched[part[cKDTree(place).query(points, distance_upper_bound=2.0)[0] < np.inf]] = True
    return triangles[touched[part[triangles[:, 0]]]]
