"""Requested relations: an object is asked for on top of, or beside, a certain other object. Is it there?

on top of: it was put on the object asked for, or on what covers that (a drape), and its bottom is within 2 cm of that
object's top where it stands (or within that object, see
:func:`~.support_gaps.support_gaps`). beside: the gap between the two footprints
is at most half a metre, and they share at least a quarter of the lower one's height.
"""

from __future__ import annotations

import numpy as np

from ..dataset.assets.asset import object_graph
from ..generate.observe.placeable import Placeable
from ..generate.propose.requests import BESIDE, COVERING, SHARED, THIN
from ..geometry.arrays import Floats
from ..geometry.planar import footprint_gap, heading, rotate
from ..scene import SceneGraph, world_matrices
from ..spatial import find_supports
from .scene_validity import OFF_SUPPORT
from .support_gaps import support_gaps


def is_on(graph: SceneGraph, row: int, target: str) -> bool:
    """Whether a row stands on the entity with that uid, see the top of this file."""
    found = find_supports(graph)
    on = {int(support) for support in found.on[found.row == row]}
    below = {int(under): other for other in on for under in found.on[found.row == other]}
    wanted = graph.row_of_uid[target]
    reached = wanted in on or (wanted in below and _covers(graph, below[wanted], wanted))
    mask = np.arange(len(graph)) == row
    return reached and bool(abs(support_gaps(graph, mask, found)[row]) <= OFF_SUPPORT)


def _covers(graph: SceneGraph, cover: int, row: int) -> bool:
    own, under = half_of(graph, cover), half_of(graph, row)
    return bool(2 * own[2] <= THIN and own[:2].prod() >= COVERING * under[:2].prod())


def is_beside(graph: SceneGraph, row: int, target: str) -> bool:
    """Whether a row stands beside the entity with that uid, see the top of this file."""
    other = graph.row_of_uid[target]
    mine, theirs = place_of(graph, row), place_of(graph, other)
    half, wide = half_of(graph, row), half_of(graph, other)
    shared = min(mine[2] + 2 * half[2], theirs[2] + 2 * wide[2]) - max(mine[2], theirs[2])
    if shared < SHARED * 2 * min(half[2], wide[2]):
        return False
    return bool(footprint_gap(theirs[:3], wide, float(theirs[3]), mine[None], half)[0] <= BESIDE)


def half_of(graph: SceneGraph, row: int) -> Floats:
    """Half extents (3,) of an entity's upright box, metres."""
    return Placeable(object_graph(graph, row)).half


def place_of(graph: SceneGraph, row: int) -> Floats:
    """Place (4,) of an entity: x, y and bottom of its upright box's middle, metres, and its turn, radians."""
    world = world_matrices(graph)
    yaw = float(heading(world[row, :3, :3]))
    foot = rotate(Placeable(object_graph(graph, row, world=world)).foot, yaw)
    return np.array([*(world[row, :3, 3] + foot), yaw])
