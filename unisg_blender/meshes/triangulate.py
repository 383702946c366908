"""Triangles of polygon faces that lie inside the faces, also where a face is concave.

Why not mapbox_earcut: it has no wheels for the Python of Blender 4.2, and faces are few and small.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.arrays import Floats, Ints
from ..scene.mesh import Mesh

CHUNK = 250_000
"""Faces looked at together, so that a mesh of millions of faces needs little memory."""
LONGEST_CLIPPED = 2000
"""Faces with more corners keep their fan: clipping takes a time that grows with the square of the corners."""


def area_vectors(points: NDArray[np.floating], triangles: NDArray[np.integer]) -> Floats:
    """(T, 3): vectors along the normals of triangles (T, 3) over points (V, 3), as long as twice their areas."""
    a, b, c = points[triangles].astype(np.float64).swapaxes(0, 1)
    return np.cross(b - a, c - a)


def inner_triangles(mesh: Mesh) -> NDArray[np.int32]:
    """int32 (T, 3): the mesh's triangles, concave faces cut by ear clipping instead of a fan.

    A fan (:attr:`~unisg_blender.scene.Mesh.triangles`) covers ground outside of a
    concave face. Triangles that use a point that is not finite are left out.
    """
    sizes = np.diff(mesh.offsets)
    triangles = mesh.triangles
    if (sizes > 3).any():
        triangles = _cut_concave(mesh, triangles, sizes)
    finite = np.isfinite(mesh.points).all(axis=1)
    return triangles if finite.all() else triangles[finite[triangles].all(axis=1)]


def _cut_concave(mesh: Mesh, triangles: NDArray[np.int32], sizes: NDArray[np.int32]) -> NDArray[np.int32]:
    face = np.repeat(np.arange(len(sizes)), np.maximum(sizes - 2, 0))
    starts = range(0, len(sizes), CHUNK)
    concave = np.concatenate(
        [_concave_faces(mesh.points, triangles, face, start, min(start + CHUNK, len(sizes))) for start in starts]
    )
    concave = concave[sizes[concave] <= LONGEST_CLIPPED]
    if not len(concave):
        return triangles
    clipped = [clip_ears(mesh.points, mesh.corners[mesh.offsets[f] : mesh.offsets[f + 1]]) for f in concave]
    return np.concatenate([triangles[~np.isin(face, concave)], *clipped]).astype(np.int32)


def _concave_faces(
    points: NDArray[np.float32], triangles: NDArray[np.int32], face: Ints, start: int, stop: int
) -> Ints:
    """Those of the faces ``start`` to ``stop`` with a fan triangle that turns against the face's area vector."""
    first, last = np.searchsorted(face, (start, stop))
    own = face[first:last] - start
    normals = area_vectors(points, triangles[first:last])
    total = np.stack([np.bincount(own, normals[:, k], stop - start) for k in range(3)], axis=1)
    along = np.einsum("tk,tk->t", normals, total[own])
    against = along < -1e-9 * np.einsum("fk,fk->f", total, total)[own]
    return start + np.unique(own[against])


def clip_ears(points: NDArray[np.floating], corners: NDArray[np.integer]) -> NDArray[np.int32]:
    """Cut one polygon into triangles by clipping ears.

    Parameters
    ----------
    points
        (V, 3) positions.
    corners
        (K,) point numbers around the polygon, K >= 3.

    Returns
    -------
    int32 (K - 2, 3): triangles with the polygon's orientation. A polygon that
    crosses itself has no ear at some step; what remains then becomes a fan.
    """
    flat = _project(points[corners].astype(np.float64))
    ring = list(range(len(corners)))
    cut: list[tuple[int, int, int]] = []
    while len(ring) > 3:
        ear = next((k for k in range(len(ring)) if _is_ear(flat, ring, k)), None)
        if ear is None:
            break
        cut.append((ring[ear - 1], ring[ear], ring[(ear + 1) % len(ring)]))
        del ring[ear]
    cut += [(ring[0], ring[k], ring[k + 1]) for k in range(1, len(ring) - 1)]
    return corners[np.array(cut)].astype(np.int32)


def _project(polygon: Floats) -> Floats:
    """The polygon (K, 3) in its own plane, (K, 2), counter-clockwise."""
    centred = np.nan_to_num(polygon - polygon[0])
    normal = np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0)
    axis = int(np.argmax(np.abs(normal)))
    first, second = (axis + 1) % 3, (axis + 2) % 3
    flat = centred[:, [first, second]]
    return flat if normal[axis] >= 0 else flat[:, ::-1]


def _is_ear(flat: Floats, ring: list[int], place: int) -> bool:
    a, b, c = flat[ring[place - 1]], flat[ring[place]], flat[ring[(place + 1) % len(ring)]]
    if _turn(a, b, c) <= 0:
        return False
    skipped = {ring[place - 1], ring[place], ring[(place + 1) % len(ring)]}
    others = flat[[k for k in ring if k not in skipped]]
    inside = (_turn(a, b, others) >= 0) & (_turn(b, c, others) >= 0) & (_turn(c, a, others) >= 0)
    doubled = (others == a).all(axis=1) | (others == b).all(axis=1) | (others == c).all(axis=1)
    return not (inside & ~doubled).any()


def _turn(a: Floats, b: Floats, p: Floats) -> Floats:
    """Twice the signed area of the triangles (a, b, p)."""
    ab, ap = b - a, p - a
    return ab[0] * ap[..., 1] - ab[1] * ap[..., 0]
