"""Meshes for the tests of this room."""

from __future__ import annotations

import numpy as np

from unisg_blender.meshes.sphere import sphere_template
from unisg_blender.scene import Mesh, mesh_from_faces

CUBE_FACES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]


def box(size: tuple[float, float, float] = (1.0, 1.0, 1.0), at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Mesh:
    """A box of quads with its lowest corner at a point."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    return mesh_from_faces("box", corners * size + at, CUBE_FACES)


def sphere(faces: int = 2000, radius: float = 1.0) -> Mesh:
    """A sphere of triangles."""
    points, triangles = sphere_template(faces)
    return mesh_from_faces("sphere", points * radius, triangles)


def joined(*meshes: Mesh) -> Mesh:
    """Several meshes as one of several parts."""
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    faces = [
        (mesh.corners[a:b] + start).tolist()
        for mesh, start in zip(meshes, starts, strict=False)
        for a, b in zip(mesh.offsets, mesh.offsets[1:], strict=False)
    ]
    return mesh_from_faces("joined", np.concatenate([mesh.points for mesh in meshes]), faces)


def edge_counts(triangles: np.ndarray) -> np.ndarray:
    """How often each directed edge's undirected edge is used forwards and backwards, (E, 2)."""
    directed = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    forwards = directed[:, 0] < directed[:, 1]
    _, place = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
    place = place.ravel()
    return np.stack([np.bincount(place, forwards), np.bincount(place, ~forwards)], axis=1)


def is_closed_and_oriented(triangles: np.ndarray) -> bool:
    """Every edge has two faces, which run along it in opposite directions."""
    return len(triangles) > 0 and bool((edge_counts(triangles) == 1).all())
