"""Closed meshes from oriented point clouds: screened Poisson reconstruction on a regular grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..errors import UniSGError
from ..geometry.arrays import Floats, Ints
from ..scene.mesh import Mesh, mesh_from_faces
from .isosurface import isosurface
from .poisson import solve_screened
from .simplify import with_faces

MARGIN = 0.15
"""Empty share of the grid on each side of the points."""


def reconstruct(
    points: NDArray[np.floating], normals: NDArray[np.floating], resolution: int = 96, name: str = "Reconstructed",
    faces: int | None = None,
) -> Mesh:  # fmt: skip
    """A closed, outward-oriented triangle mesh through oriented points.

    Screened Poisson reconstruction (Kazhdan and Hoppe, ToG 2013) on a regular grid:
    the solid's indicator function has the normals for its gradient and vanishes at
    the points; its level set, by marching tetrahedra, is the surface.

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
    faces
        Number of triangles, at least 4: surplus ones are simplified away, missing
        ones made by splitting. An odd number becomes the next even one; parts and
        handles that need more faces keep them. As many as the grid gives when omitted.

    Raises
    ------
    UniSGError
        If there are fewer than 4 points, they are not finite, all at one place,
        the normals do not enclose a solid, or fewer than 4 faces are asked for.
    """
    points, normals = _checked(points, normals)
    if not 16 <= resolution <= 256:
        raise UniSGError(f"the resolution must be between 16 and 256, not {resolution}")
    if faces is not None and faces < 4:
        raise UniSGError(f"a closed mesh needs 4 faces or more, not {faces}")
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    cell = float(np.ptp(points, axis=0).max()) / (resolution * (1 - 2 * MARGIN))
    size = [next_fast_len(int(side)) for side in np.ceil(np.ptp(points, axis=0) / cell + 2 * MARGIN * resolution)]
    shift = (np.array(size) - 1) / 2 - middle / cell
    place = points / cell + shift
    areas = _areas(place)
    indicator, values = solve_screened(place, normals, areas, size)
    found, triangles = isosurface(indicator - np.average(values, weights=areas))
    triangles = _near(found, triangles, place)
    if not len(triangles):
        raise UniSGError("the points enclose no solid: check that the normals all point outwards")
    found, triangles = with_faces(found, triangles, len(triangles) if faces is None else faces)
    return mesh_from_faces(name, (found - shift) * cell, triangles)


def _checked(points: NDArray[np.floating], normals: NDArray[np.floating]) -> tuple[Floats, Floats]:
    points, normals = np.asarray(points, np.float64), np.asarray(normals, np.float64)
    if points.shape != normals.shape or points.ndim != 2 or points.shape[1] != 3 or len(points) < 4:
        raise UniSGError(f"needs 4 or more points with a normal each, got shapes {points.shape} and {normals.shape}")
    if not (np.isfinite(points).all() and np.isfinite(normals).all()):
        raise UniSGError("points and normals must be finite numbers")
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    if not (length > 0).all() or not np.ptp(points, axis=0).max() > 0:
        raise UniSGError("points must not all lie at one place, and normals must not be zero")
    return points, normals / length


def _areas(place: Floats) -> Floats:
    """Surface that each point stands for, in squared cells: a fifth of the disk up to the fourth neighbour."""
    neighbours = min(5, len(place))
    distance = np.asarray(cKDTree(place).query(place, neighbours)[0])[:, -1]
    return np.pi / neighbours * np.square(np.maximum(distance, 1e-6))


def _near(points: Floats, triangles: Ints, place: Floats) -> Ints:
    """The triangles of those connected parts that come within two cells of a given point."""
    if not len(triangles):
        return triangles
    pairs = triangles[:, [0, 1, 1, 2]].reshape(-1, 2)
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points), len(points)))
    _, part = connected_components(graph, directed=False)
    touched = np.zeros(part.max() + 1, bool)
    touched[part[cKDTree(place).query(points, distance_upper_bound=2.0)[0] < np.inf]] = True
    return triangles[touched[part[triangles[:, 0]]]]
