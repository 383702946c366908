"""Closed triangle meshes brought to a chosen number of faces; they stay closed and oriented.

Why not fast-simplification: it has no wheels for the Python of Blender 4.2, and promises no closed mesh.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix

from ..geometry.arrays import Bools, Floats, Ints
from .triangulate import area_vectors

CHEAPEST = 0.3
"""Share of the edges that are looked at in one round, the cheapest ones first."""
LEAST_AGREEMENT = 0.2
"""Cosine of the angle by which a collapse may turn a face at most."""


def with_faces(points: NDArray[np.floating], triangles: NDArray[np.integer], faces: int) -> tuple[Floats, Ints]:
    """A closed mesh with a chosen number of triangles.

    Surplus faces go by edge collapses with quadric errors (Garland and Heckbert,
    "Surface Simplification Using Quadric Error Metrics", SIGGRAPH 1997), in
    rounds of collapses that do not touch each other; missing ones come from
    splitting the longest edges.

    Parameters
    ----------
    points, triangles
        (V, 3) and (T, 3): closed and oriented, each edge in two faces.
    faces
        Number of triangles; an odd one becomes the next even one. What cannot be
        simplified so far (each part keeps 4 faces, each handle some more) has more.

    Returns
    -------
    Points (W, 3) and triangles (F, 3).
    """
    wanted = faces + faces % 2
    place, found = points.astype(np.float64), triangles.astype(np.int64)
    if len(found) > wanted:
        place, found = _collapsed(place, found, wanted)
    while len(found) < wanted:
        place, found = _split(place, found, (wanted - len(found)) // 2)
    used, found = np.unique(found, return_inverse=True)
    return place[used], found.reshape(-1, 3)


def edges_of(triangles: Ints) -> tuple[Ints, Ints]:
    """Edges (E, 2) of a closed mesh, lower point first, and the points (E, 2) opposite to each in its two faces."""
    directed = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    opposite = triangles[:, [2, 0, 1]].ravel()
    order = np.lexsort((directed.max(axis=1), directed.min(axis=1)))
    return np.sort(directed[order[::2]], axis=1), opposite[order].reshape(-1, 2)


def _collapsed(points: Floats, triangles: Ints, wanted: int) -> tuple[Floats, Ints]:
    points, quadrics, share = points.copy(), _quadrics(points, triangles), CHEAPEST
    while len(triangles) > wanted:
        edges, opposite = edges_of(triangles)
        place, cost = _best_places(points, quadrics, edges)
        cheap = np.argsort(cost, kind="stable")[: max(int(share * len(edges)), 100)]
        cheap = cheap[_keeps_surface(edges[cheap], opposite[cheap], edges, len(points))]
        cheap = cheap[~_turns_faces(points, triangles, edges[cheap], place[cheap])]
        chosen = cheap[_apart(edges[cheap], edges, len(points))][: (len(triangles) - wanted + 1) // 2]
        if not len(chosen):
            if share == 1:
                break
            share = 1.0
            continue
        kept, gone = edges[chosen].T
        points[kept] = place[chosen]
        quadrics[kept] += quadrics[gone]
        target = np.arange(len(points))
        target[gone] = kept
        triangles = target[triangles]
        a, b, c = triangles.T
        triangles = triangles[(a != b) & (b != c) & (c != a)]
    return points, triangles


def _quadrics(points: Floats, triangles: Ints) -> Floats:
    """(V, 4, 4): sums of squared distances to the planes of each point's faces, weighted by area."""
    normal = area_vectors(points, triangles)
    length = np.linalg.norm(normal, axis=1)
    plane = (
        np.column_stack([normal, -np.einsum("tk,tk->t", normal, points[triangles[:, 0]])])
        / np.maximum(length, 1e-300)[:, None]
    )
    quadric = (length[:, None, None] * plane[:, :, None] * plane[:, None, :]).reshape(-1, 16)
    corner = coo_matrix(
        (np.ones(triangles.size), (triangles.ravel(), np.repeat(np.arange(len(triangles)), 3))),
        shape=(len(points), len(triangles)),
    )
    return (csr_matrix(corner) @ quadric).reshape(-1, 4, 4)


def _best_places(points: Floats, quadrics: Floats, edges: Ints) -> tuple[Floats, Floats]:
    """Where each edge (E, 2) collapses to, (E, 3), and the cost (E,); ties in flat regions go to short edges."""
    quadric = quadrics[edges[:, 0]] + quadrics[edges[:, 1]]
    middle = points[edges].mean(axis=1)
    pull = 1e-3 * np.trace(quadric[:, :3, :3], axis1=1, axis2=2) + 1e-300
    system = quadric[:, :3, :3] + pull[:, None, None] * np.eye(3)
    place = np.linalg.solve(system, (pull[:, None] * middle - quadric[:, :3, 3])[:, :, None])[:, :, 0]
    one = np.column_stack([place, np.ones(len(place))])
    length = np.square(points[edges[:, 0]] - points[edges[:, 1]]).sum(axis=1)
    return place, np.einsum("ei,eij,ej->e", one, quadric, one) + 1e-3 * pull * length


def _keeps_surface(asked: Ints, opposite: Ints, edges: Ints, count: int) -> Bools:
    """Whether collapsing the edges leaves a surface: the ends share two neighbours only, which have others left."""
    near = csr_matrix((np.ones(len(edges)), edges.T), shape=(count, count))
    near = csr_matrix(near + near.T)
    shared = np.asarray(near[asked[:, 0]].multiply(near[asked[:, 1]]).sum(axis=1)).ravel()
    degree = np.diff(near.indptr)
    return (shared == 2) & (degree[opposite] > 3).all(axis=1)


def _turns_faces(points: Floats, triangles: Ints, edges: Ints, place: Floats) -> Bools:
    """Whether moving both ends of the edges (E, 2) to their places (E, 3) turns a face that remains too far."""
    order = np.argsort(triangles.ravel(), kind="stable")
    start = np.searchsorted(triangles.ravel()[order], np.arange(len(points) + 1))
    bad = np.zeros(len(edges), bool)
    for end in range(2):
        first = start[edges[:, end]]
        many = start[edges[:, end] + 1] - first
        owner = np.repeat(np.arange(len(edges)), many)
        corner = order[np.arange(len(owner)) - np.repeat(np.cumsum(many) - many, many) + first[owner]]
        face = triangles[corner // 3]
        remains = ~(face == edges[owner, 1 - end][:, None]).any(axis=1)
        owner, corner, face = owner[remains], corner[remains], face[remains]
        corners = points[face]
        before = area_vectors(points, face)
        corners[np.arange(len(face)), corner % 3] = place[owner]
        after = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
        bad[owner[np.einsum("tk,tk->t", before, after) <= LEAST_AGREEMENT * lengths]] = True
    return bad


def _apart(ranked: Ints, edges: Ints, count: int) -> Bools:
    """Which of the edges (best first) are the best ones around both of their ends, as far as the next points."""
    rank = np.full(count, len(ranked))
    np.minimum.at(rank, ranked.ravel(), np.repeat(np.arange(len(ranked)), 2))
    around = rank.copy()
    np.minimum.at(around, edges[:, 0], rank[edges[:, 1]])
    np.minimum.at(around, edges[:, 1], rank[edges[:, 0]])
    return np.asarray((around[ranked] == np.arange(len(ranked))[:, None]).all(axis=1))


def _split(points: Floats, triangles: Ints, count: int) -> tuple[Floats, Ints]:
    """Split at most ``count`` edges, the longest of their faces, in the middle."""
    length = np.linalg.norm(points[triangles] - points[np.roll(triangles, -1, axis=1)], axis=2)
    place = length.argmax(axis=1)
    rows = np.arange(len(triangles))
    turned = triangles[rows[:, None], (place[:, None] + np.arange(3)) % 3]
    edge = np.sort(turned[:, :2], axis=1)
    order = np.lexsort((edge[:, 1], edge[:, 0]))
    same = (edge[order[1:]] == edge[order[:-1]]).all(axis=1)
    first, second = order[:-1][same], order[1:][same]
    longest = np.argsort(-length[first, place[first]], kind="stable")[:count]
    first, second = first[longest], second[longest]
    middle = len(points) + np.arange(len(first))
    points = np.concatenate([points, points[turned[first, :2]].mean(axis=1)])
    halves = []
    for face in (first, second):
        halves.append(np.column_stack([middle, turned[face, 1], turned[face, 2]]))
        turned[face, 1] = middle
    return points, np.concatenate([turned, *halves])
