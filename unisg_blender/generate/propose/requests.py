"""Requests: new objects on, or beside, a certain other object."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...geometry.planar import footprint_gap, rotate, turned_reach
from ...spatial.relation_tolerances import RelationTolerances
from ..observe.observed_scene import ObservedScene
from .proposer import Proposals, Proposer, Query, Upcoming

DRAWS = 24
"""How many times as many proposals are drawn; those that are beside the object come first."""

SHIFTED = 4
"""One in so many proposals is shifted to beside the object: the model may hardly ever put anything there by itself."""

BESIDE, SHARED = RelationTolerances().beside, RelationTolerances().shared

THIN, COVERING = 0.06, 0.5
"""What is no higher than this, metres, and has this share of the footprint of what it lies on covers it: a drape."""

APART = 100.0
"""Metres that are added to the gap of objects at different heights: those come last, the nearest of them first."""

ROUNDING = 1e-6
"""Metres by which what is shifted to beside an object may be off."""


class On(Proposer):
    """Proposals of another proposer on an object (its number in the scene), or on what covers it.

    Where objects of that category are usual there, as the model likes; else on the highest surface.

    Parameters
    ----------
    usual
        bool (C, C + 1), see :class:`~..observe.prior_tables.PriorTables`.
    """

    def __init__(self, proposer: Proposer, obj: int, usual: Bools) -> None:
        self.proposer, self.obj, self.usual = proposer, obj, usual

    def holders(self, scene: ObservedScene) -> Bools:
        """The object and what covers it (K,)."""
        return covers(scene, self.obj) | (np.arange(len(scene.category)) == self.obj)

    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """See :class:`~.proposer.Proposer`; ``allowed`` does not count."""
        scene, lying = query.scene, covers(query.scene, self.obj)
        usual = self.holders(scene) & self.usual[query.category][scene.category]
        if usual[lying].any() or (usual.any() and not lying.any()):
            return self.proposer.propose(replace(query, allowed=usual), count, rng)
        top = int(np.flatnonzero(lying)[0]) if lying.any() else self.obj
        query, surfaces = replace(query, allowed=np.arange(len(lying)) == top), len(scene.surfaces(top))
        if not surfaces:
            return self.proposer.propose(query, count, rng)
        return self.proposer.propose_on(query, count, rng, (top, surfaces - 1), Upcoming(query.coming))


def covers(scene: ObservedScene, obj: int) -> Bools:
    """Which objects (K,) lie on an object and cover it."""
    area, own = scene.half[:, :2].prod(axis=1), scene.half[obj, :2].prod()
    return (scene.support == obj) & (2 * scene.half[:, 2] <= THIN) & (area >= COVERING * own)


class Beside(Proposer):
    """Proposals of another proposer that are beside an object, given by its number in the scene."""

    def __init__(self, proposer: Proposer, obj: int) -> None:
        self.proposer, self.obj = proposer, obj

    def has(self, scene: ObservedScene, half: Floats, place: Floats) -> bool:
        """Is an object of half extents (3,) at a place (4,) beside it?"""
        return bool(aside(scene, self.obj, half, place[None])[0] <= BESIDE + ROUNDING)

    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """See :class:`~.proposer.Proposer`; on the object's own surface, if that may hold the new one."""
        scene, support, surface = query.scene, int(query.scene.support[self.obj]), int(query.scene.surface[self.obj])
        if support >= 0 and query.allowed[support] and surface >= 0:
            row = Upcoming(query.coming)
            found = self.proposer.propose_on(query, DRAWS * count, rng, (support, surface), row)
        else:
            found = self.proposer.propose(query, DRAWS * count, rng)
        half = query.placeable.half
        likely = _nearest(scene, self.obj, half, found, count - count // SHIFTED)
        places = np.concatenate([likely.places, _shifted(scene, self.obj, half, found.places[:count], rng)])
        both = Proposals(np.concatenate([likely.support, found.support[:count]]), places)
        return _nearest(scene, self.obj, half, both, count)


def _nearest(scene: ObservedScene, obj: int, half: Floats, found: Proposals, count: int) -> Proposals:
    """So many proposals: those beside an object first, then the nearest; else in their order."""
    gaps = np.maximum(aside(scene, obj, half, found.places), BESIDE)
    order = np.argsort(gaps, kind="stable")[:count]
    return Proposals(found.support[order], found.places[order])


def _shifted(scene: ObservedScene, obj: int, half: Floats, places: Floats, rng: np.random.Generator) -> Floats:
    """Places (T, 4) shifted, as high and turned as they are, to anywhere along the sides of an object."""
    count, yaw, own = len(places), float(scene.yaw[obj]), scene.half[obj, :2]
    reach = own + turned_reach(half, places[:, 3] - yaw)
    axis, side = rng.integers(2, size=count), rng.choice([-1.0, 1.0], size=count)
    local, each = rng.uniform(-1, 1, (count, 2)) * own, np.arange(count)
    local[each, axis] = side * (reach[each, axis] + rng.uniform(0, BESIDE, count))
    return np.column_stack([scene.center[obj, :2] + rotate(local, yaw), places[:, 2:]])


def aside(scene: ObservedScene, obj: int, half: Floats, places: Floats) -> Floats:
    """Gaps (T,) between the footprints of an object and of another at places (T, 4), metres; at other heights more.

    The other's half extents are ``half`` (3,); they share a height if a quarter of the lower one's is common to both,
    else :data:`APART` is added.
    """
    low, high = scene.center[obj, 2] - scene.half[obj, 2], scene.center[obj, 2] + scene.half[obj, 2]
    shared = np.minimum(high, places[:, 2] + 2 * half[2]) - np.maximum(low, places[:, 2])
    gap = footprint_gap(scene.center[obj], scene.half[obj], float(scene.yaw[obj]), places, half)
    return gap + APART * (shared < SHARED * 2 * min(half[2], scene.half[obj, 2]))
