"""Requested relations: a thing is asked for on top of, or beside, a certain other thing. Is it there?

on top of: it was put on the thing asked for, and its bottom is within 2 cm of that
thing's top where it stands (or within that thing, see
:func:`~.scene_support.support_gaps`). beside: the gap between the two footprints
is at most half a metre, and they share at least a quarter of the lower one's height.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..generate.pieces import Piece
from ..generate.proposals import Proposals, Proposer, Scene
from ..scene import SceneGraph
from ..scene.relate import RelationTolerances
from .cases import place_of
from .scene_metrics import OFF_SUPPORT
from .scene_support import find_supports, support_gaps

DRAWS = 8
"""How many times as many proposals are drawn for a place beside something; those that are beside it come first."""


class Requested:
    """Proposals of another proposer that heed a request: on one of the things, beside another, or both; -1 for any."""

    def __init__(self, proposer: Proposer, on: int = -1, beside: int = -1) -> None:
        self.proposer, self.on, self.beside = proposer, on, beside

    def propose(
        self, scene: Scene, category: int, piece: Piece, count: int, rng: np.random.Generator,
        allowed: NDArray[np.bool_], coming: Mapping[int, int],
    ) -> Proposals:  # fmt: skip
        """See :class:`~unisg_blender.generate.proposals.Proposer`."""
        if self.on >= 0:
            allowed = allowed & (np.arange(len(allowed)) == self.on)
        more = DRAWS if self.beside >= 0 else 1
        found = self.proposer.propose(scene, category, piece, more * count, rng, allowed, coming)
        if self.beside < 0:
            return found
        far = np.array([_aside(scene, self.beside, piece.half, place) for place in found.places])
        order = np.argsort(np.maximum(far, BESIDE), kind="stable")[:count]
        return Proposals(found.support[order], found.places[order])


BESIDE, SHARED = RelationTolerances().beside, RelationTolerances().shared


def _aside(scene: Scene, thing: int, half: NDArray[np.float64], place: NDArray[np.float64]) -> float:
    """Gap between the footprints of a thing and of another at a place, metres; infinite at other heights."""
    low, high = scene.center[thing, 2] - scene.half[thing, 2], scene.center[thing, 2] + scene.half[thing, 2]
    shared = min(high, place[2] + 2 * half[2]) - max(low, place[2])
    if shared < SHARED * 2 * min(half[2], scene.half[thing, 2]):
        return np.inf
    return footprint_gap(scene.center[thing], scene.half[thing], float(scene.yaw[thing]), place, half)


def footprint_gap(
    center: NDArray[np.float64], half: NDArray[np.float64], yaw: float, place: NDArray[np.float64],
    other: NDArray[np.float64],
) -> float:  # fmt: skip
    """Largest separation along the axes of two rectangles seen from above, metres; negative where they overlap."""
    offset = place[:2] - center[:2]
    cos, sin = abs(np.cos(place[3] - yaw)), abs(np.sin(place[3] - yaw))
    gaps = []
    for turn, own, them in ((yaw, half, other), (place[3], other, half)):
        c, s = np.cos(turn), np.sin(turn)
        seen = np.abs([c * offset[0] + s * offset[1], c * offset[1] - s * offset[0]])
        reach = np.array([cos * them[0] + sin * them[1], sin * them[0] + cos * them[1]])
        gaps.append((seen - own[:2] - reach).max())
    return float(max(gaps))


def is_on(graph: SceneGraph, row: int, target: str) -> bool:
    """Whether a row stands on the entity with that uid, see the top of this file."""
    found = find_supports(graph)
    on = {graph.uid[support] for support in found.on[found.row == row]}
    mask = np.arange(len(graph)) == row
    return target in on and bool(abs(support_gaps(graph, mask)[row]) <= OFF_SUPPORT)


def is_beside(graph: SceneGraph, row: int, target: str) -> bool:
    """Whether a row stands beside the entity with that uid, see the top of this file."""
    other = graph.row_of_uid[target]
    mine, theirs = place_of(graph, row), place_of(graph, other)
    half, wide = half_of(graph, row), half_of(graph, other)
    shared = min(mine[2] + 2 * half[2], theirs[2] + 2 * wide[2]) - max(mine[2], theirs[2])
    if shared < SHARED * 2 * min(half[2], wide[2]):
        return False
    return footprint_gap(theirs[:3], wide, theirs[3], mine, half) <= BESIDE


def half_of(graph: SceneGraph, row: int) -> NDArray[np.float64]:
    """Half extents (3,) of an entity's upright box, metres."""
    from ..dataset.assets import thing_of

    return Piece(thing_of(graph, row)).half
