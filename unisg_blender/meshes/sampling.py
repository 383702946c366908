"""Poisson-disk (blue-noise) samples of a mesh's surface: exactly as many as asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..errors import UniSGError
from ..geometry.arrays import Floats, Ints
from ..scene.mesh import Mesh
from .triangulate import area_vectors, inner_triangles

OVERSAMPLING = 2.5
CHUNK = 250_000
"""Triangles measured at once, so that a mesh of millions of faces needs little memory."""


class NoSurfaceError(UniSGError):
    """A mesh has no faces with an area."""


@dataclass(frozen=True, eq=False)
class SurfaceSamples:
    """Points on a surface.

    ``points`` float32 (n, 3) in the mesh's frame and unit; ``normals`` float32
    (n, 3) unit normals of the faces they lie on; ``faces`` int32 (n,) numbers of
    the triangles they lie on; ``area`` of the whole surface.
    """

    points: NDArray[np.float32]
    normals: NDArray[np.float32]
    faces: NDArray[np.int32]
    area: float


def sample_surface(mesh: Mesh, count: int, seed: int = 0) -> SurfaceSamples:
    """Exactly ``count`` blue-noise points of a mesh's surface.

    Two and a half times as many uniform random points are thinned out by weighted sample
    elimination (Yuksel, "Sample Elimination for Generating Poisson Disk Sample
    Sets", Eurographics 2015) with straight-line distances, in rounds that remove
    all local maxima of the weight at once (the weight's exponent alpha is 8).

    Parameters
    ----------
    mesh
        Any polygon mesh: open, non-manifold, of several parts, with faces of no
        area. Faces that touch a point that is not finite are left out.
    count
        Number of points, at least 1.
    seed
        The same mesh, count and seed always give the same points.

    Raises
    ------
    NoSurfaceError
        If the mesh has no faces, or none with an area.
    UniSGError
        If ``count`` is below 1.
    """
    if count < 1:
        raise UniSGError(f"the number of samples must be 1 or more, not {count}")
    triangles = inner_triangles(mesh)
    areas = triangle_areas(mesh.points, triangles)
    if not areas.sum() > 0:
        raise NoSurfaceError(f"mesh {mesh.name!r} has no surface to sample: it needs faces with an area")
    generator = np.random.default_rng(seed)
    points, faces = _uniform(mesh.points, triangles, areas, int(np.ceil(OVERSAMPLING * count)), generator)
    kept = eliminate(points, count, float(areas.sum()))
    normals = area_vectors(mesh.points, triangles[faces[kept]])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return SurfaceSamples(
        points[kept].astype(np.float32), normals.astype(np.float32), faces[kept].astype(np.int32), float(areas.sum())
    )


def triangle_areas(points: NDArray[np.floating], triangles: NDArray[np.integer]) -> Floats:
    """float64 (T,): areas of triangles (T, 3) over points (V, 3), in squared units of the points."""
    areas = np.empty(len(triangles))
    for start in range(0, len(triangles), CHUNK):
        areas[start : start + CHUNK] = (
            np.linalg.norm(area_vectors(points, triangles[start : start + CHUNK]), axis=1) / 2
        )
    return areas


def poisson_radius(area: float, count: int) -> float:
    """The largest distance that ``count`` points in a plane of that area can all keep: hexagonal packing."""
    return float(np.sqrt(2 * area / (np.sqrt(3) * count)))


def eliminate(points: NDArray[np.floating], count: int, area: float) -> Ints:
    """Row numbers (ascending) of the ``count`` points that remain when the most crowded ones go first.

    ``points`` (N, 3), N >= count; ``area`` of the surface that they cover.
    """
    alive = np.ones(len(points), bool)
    reach = poisson_radius(area, count)
    tree = cKDTree(points, balanced_tree=False)
    pairs = tree.query_pairs(reach, output_type="ndarray")
    first, second = pairs.T.copy()
    apart = points[first] - points[second]
    weight = np.square(np.square(np.square(1 - np.sqrt(np.einsum("pk,pk->p", apart, apart)) / reach)))
    surplus = len(points) - count
    while surplus > 0:
        crowding = np.zeros(len(points))
        crowding += np.bincount(first, weight, len(points))
        crowding += np.bincount(second, weight, len(points))
        crowding[~alive] = -1
        worst = np.partition(crowding, -surplus)[-surplus]  # local maxima below it would survive one-by-one removal
        removed = _local_maxima(crowding, first, second, worst)[:surplus]
        alive[removed] = False
        surplus -= len(removed)
        near = alive[first] & alive[second]
        first, second, weight = first[near], second[near], weight[near]
    return np.flatnonzero(alive)


def _local_maxima(crowding: Floats, first: Ints, second: Ints, worst: float) -> Ints:
    """Points at least as crowded as ``worst`` and more than each neighbour (of equals, those that come first)."""
    candidate = crowding >= worst
    behind = (crowding[first] < crowding[second]) | ((crowding[first] == crowding[second]) & (second < first))
    candidate[np.where(behind, first, second)] = False
    return np.flatnonzero(candidate)


def _uniform(
    points: NDArray[np.float32], triangles: NDArray[np.int32], areas: Floats, count: int, generator: np.random.Generator
) -> tuple[Floats, Ints]:
    """Random points of the surface, stratified over its area, and the triangles they lie on."""
    bounds = np.cumsum(areas)
    place = (np.arange(count) + generator.random(count)) / count * bounds[-1]
    faces = np.minimum(np.searchsorted(bounds, place, side="right"), np.flatnonzero(areas)[-1])
    u, v = generator.random((2, count, 1))
    folded = u + v > 1
    u, v = np.where(folded, 1 - u, u), np.where(folded, 1 - v, v)
    a, b, c = points[triangles[faces]].astype(np.float64).swapaxes(0, 1)
    return a + u * (b - a) + v * (c - a), faces
