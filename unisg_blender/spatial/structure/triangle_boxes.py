"""Thin boxes over triangles: the obstacles that a mesh makes whose own box is full of air, such as a house."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Floats
from ...geometry.boxes import Boxes
from ...geometry.corner_ends import corner_ends
from ...geometry.surface_contact import Triangles

SQUARE = 0.1
"""Cosine of the angle at the squarest corner up to which a box around a triangle is what two of them fill."""

LARGE, HALVINGS = 0.4, 5
"""Metres of the longest edge up to which other triangles are parted into four, and how often at most."""

SMALL = 1e-4
"""Square metres of a triangle that is no obstacle."""


def triangle_boxes(triangles: Triangles) -> Boxes:
    """Flat boxes that cover triangles (M, 3, 3).

    They lie along the edges of the squarest corner: two triangles that make a rectangle have its box. Large ones
    without a square corner are parted first.
    """
    whole, rest = [], triangles
    for _ in range(HALVINGS):
        corner, cosine = _squarest(rest)
        edges = np.linalg.norm(rest - np.roll(rest, 1, axis=1), axis=2).max(axis=1, initial=0)
        good = (np.abs(cosine) <= SQUARE) | (edges <= LARGE)
        whole.append(corner[good])
        rest = _parted(rest[~good])
    corner = np.concatenate([*whole, _squarest(rest)[0]])
    one, two = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    normal = np.cross(one, two)
    size = np.linalg.norm(normal, axis=1)
    kept = size > 2 * SMALL
    one, two, normal, corner = one[kept], two[kept], normal[kept] / size[kept, None], corner[kept]
    along = one / np.linalg.norm(one, axis=1, keepdims=True)
    axes = np.stack([along, np.cross(normal, along), normal], axis=2)
    seen = np.einsum("mki,mij->mkj", corner - corner[:, :1], axes)
    low, high = corner_ends(seen)
    center = corner[:, 0] + np.einsum("mij,mj->mi", axes, (low + high) / 2)
    return Boxes(center, axes, (high - low) / 2, np.ones(len(center), bool))


def _squarest(triangles: Triangles) -> tuple[Triangles, Floats]:
    """The triangles from their squarest corner on, its longer edge first, and the cosine there."""
    cosines = []
    for corner in range(3):
        one, two = (triangles[:, (corner + step) % 3] - triangles[:, corner] for step in (1, 2))
        length = np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1)
        cosines.append(np.einsum("mi,mi->m", one, two) / np.maximum(length, 1e-300))
    cosine = np.stack(cosines, axis=1)
    best = np.abs(cosine).argmin(axis=1)
    each = np.arange(len(triangles))
    turned = np.stack([triangles[each, (best + step) % 3] for step in range(3)], axis=1)
    one, two = (np.linalg.norm(turned[:, step] - turned[:, 0], axis=1) for step in (1, 2))
    turned[two > one] = turned[two > one][:, [0, 2, 1]]
    return turned, cosine[each, best]


def _parted(triangles: Triangles) -> Triangles:
    """Four triangles for each."""
    a, b, c = (triangles[:, corner] for corner in range(3))
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(part, axis=1) for part in parts])
