"""Relations of place between objects that do not touch: above, beside, left, right, in front, behind."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats, Ints
from ..geometry.box_overlap import nearby_pairs
from ..geometry.boxes import Boxes
from ..geometry.planar import rotate
from ..geometry.polygon import convex_gap
from .object_rows import Objects
from .relation_tolerances import RelationTolerances

OPPOSITE = {"left_of": "right_of", "in_front_of": "behind", "above": "below", "beside": "beside"}


def directions(
    objects: Objects, tolerances: RelationTolerances, joined: set[tuple[int, int]]
) -> list[tuple[int, str, int]]:
    """Relations of place, both ways: (subject, kind, target) as numbers of objects.

    Pairs in ``joined`` (smaller number first) are left out: they rest on each other,
    lie in each other or are connected.
    """
    found = []
    for kind, subject, target in _vertical(objects, tolerances) + _horizontal(objects, tolerances):
        if (min(subject, target), max(subject, target)) not in joined:
            found += [(subject, kind, target), (target, OPPOSITE[kind], subject)]
    return found


def _grown(objects: Objects, horizontal: float, vertical: float) -> Boxes:
    boxes = objects.aligned
    return Boxes(boxes.center, boxes.axes, boxes.half + np.array([horizontal, horizontal, vertical]) / 2, boxes.solid)


def _vertical(objects: Objects, tolerances: RelationTolerances) -> list[tuple[str, int, int]]:
    pairs = nearby_pairs(_grown(objects, 0.0, tolerances.above))
    low, high = objects.bounds[:, pairs]
    common = np.minimum(high[:, 0, :2], high[:, 1, :2]) - np.maximum(low[:, 0, :2], low[:, 1, :2])
    smaller = np.minimum(high[:, 0, :2] - low[:, 0, :2], high[:, 1, :2] - low[:, 1, :2])
    over = (common > 0).all(axis=1) & (common.prod(axis=1) >= tolerances.shared * smaller.prod(axis=1))
    first_over = over & (low[:, 0, 2] >= high[:, 1, 2] - tolerances.overlap)
    second_over = over & (low[:, 1, 2] >= high[:, 0, 2] - tolerances.overlap) & ~first_over
    return [("above", one, two) for one, two in pairs[first_over].tolist()] + [
        ("above", two, one) for one, two in pairs[second_over].tolist()
    ]


def _horizontal(objects: Objects, tolerances: RelationTolerances) -> list[tuple[str, int, int]]:
    pairs = nearby_pairs(_grown(objects, tolerances.beside, 0.0))
    low, high = objects.bounds[:, pairs]
    common = np.minimum(high[:, 0, 2], high[:, 1, 2]) - np.maximum(low[:, 0, 2], low[:, 1, 2])
    lower = np.minimum(high[:, 0, 2] - low[:, 0, 2], high[:, 1, 2] - low[:, 1, 2])
    space = np.maximum(low[:, 0, :2], low[:, 1, :2]) - np.minimum(high[:, 0, :2], high[:, 1, :2])
    distance = np.linalg.norm(np.maximum(space, 0), axis=1)
    level = (common >= tolerances.shared * lower) & (common > 0)
    apart = (space >= -tolerances.overlap).any(axis=1)
    for pair in np.flatnonzero(level & ~apart):  # turned things can be apart though their boxes overlap
        distance[pair] = convex_gap(*(objects.footprint(int(obj)) for obj in pairs[pair]))
        apart[pair] = distance[pair] > 0
    level &= apart & (distance <= tolerances.beside)
    pairs, offset = pairs[level], _seen(objects, pairs[level], tolerances.heading)
    sideways = np.abs(offset[:, 0]) >= np.abs(offset[:, 1])
    found = [("beside", one, two) for one, two in pairs.tolist()]
    for kind, axis, chosen in (("left_of", 0, sideways), ("in_front_of", 1, ~sideways)):
        turned = offset[:, axis] < 0  # the second stands farther left, or nearer to the viewer
        found += [(kind, one, two) for one, two in pairs[chosen & ~turned].tolist()]
        found += [(kind, two, one) for one, two in pairs[chosen & turned].tolist()]
    return found


def _seen(objects: Objects, pairs: Ints, heading: float) -> Floats:
    """From the first's middle to the second's, (K, 2): to the viewer's right, and away from the viewer."""
    offset = objects.aligned.center[pairs[:, 1], :2] - objects.aligned.center[pairs[:, 0], :2]
    return rotate(offset, -heading)
