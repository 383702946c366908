"""Requests: new objects on, or beside, a certain other object."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...geometry.boxes import turned_reach
from ...geometry.planar import footprint_gap
from ...spatial.relations import RelationTolerances
from ..observe.observed_scene import ObservedScene
from ..observe.placeable import Placeable
from .anchor_proposer import AnchorProposer, Upcoming
from .proposer import Proposals, Proposer

DRAWS = 24
"""How many times as many proposals are drawn; those that are beside the object come first."""

SHIFTED = 4
"""One in so many proposals is shifted to beside the object: the model may hardly ever put anything there by itself."""

BESIDE, SHARED = RelationTolerances().beside, RelationTolerances().shared

THIN, COVERING = 0.06, 0.5
"""What is no higher than this, metres, and has this share of the footprint of what it lies on covers it: a drape."""

APART = 100.0
"""Metres that are added to the gap of objects at different heights: those come last, the nearest of them first."""


class On:
    """Proposals of another proposer on an object (its number in the scene), or on what covers it.

    Where objects of that category are usual there, as the model likes; else on the highest surface.

    Parameters
    ----------
    usual
        bool (C, C + 1), see :func:`~..place.planning.usual_kinds`.
    """

    def __init__(self, proposer: Proposer, obj: int, usual: NDArray[np.bool_]) -> None:
        self.proposer, self.obj, self.usual = proposer, obj, usual

    def propose(
        self, scene: ObservedScene, category: int, placeable: Placeable, count: int, rng: np.random.Generator,
        allowed: NDArray[np.bool_], coming: Mapping[int, int],
    ) -> Proposals:  # fmt: skip
        """See :class:`~.proposer.Proposer`; ``allowed`` does not count."""
        lying = covers(scene, self.obj)
        on = lying | (np.arange(len(lying)) == self.obj)
        usual = on & self.usual[category][scene.category]
        if usual[lying].any() or (usual.any() and not lying.any()):
            return self.proposer.propose(scene, category, placeable, count, rng, usual, coming)
        top = int(np.flatnonzero(lying)[0]) if lying.any() else self.obj
        if isinstance(self.proposer, AnchorProposer) and len(scene.surfaces(top)):
            candidate = top, len(scene.surfaces(top)) - 1
            return self.proposer.propose_on(scene, category, placeable, count, rng, candidate, Upcoming(coming, 0.0))
        return self.proposer.propose(scene, category, placeable, count, rng, np.arange(len(on)) == top, coming)


def covers(scene: ObservedScene, obj: int) -> NDArray[np.bool_]:
    """Which objects (K,) lie on an object and cover it."""
    area, own = scene.half[:, :2].prod(axis=1), scene.half[obj, :2].prod()
    return (scene.support == obj) & (2 * scene.half[:, 2] <= THIN) & (area >= COVERING * own)


class Beside:
    """Proposals of another proposer that are beside an object, given by its number in the scene."""

    def __init__(self, proposer: Proposer, obj: int) -> None:
        self.proposer, self.obj = proposer, obj

    def propose(
        self, scene: ObservedScene, category: int, placeable: Placeable, count: int, rng: np.random.Generator,
        allowed: NDArray[np.bool_], coming: Mapping[int, int],
    ) -> Proposals:  # fmt: skip
        """See :class:`~.proposer.Proposer`; on the object's own surface, if that may hold the new one."""
        support = int(scene.support[self.obj])
        candidate = support, int(scene.surface[self.obj])
        if isinstance(self.proposer, AnchorProposer) and support >= 0 and allowed[support] and candidate[1] >= 0:
            found = self.proposer.propose_on(
                scene, category, placeable, DRAWS * count, rng, candidate, Upcoming(coming, 0.0)
            )
        else:
            found = self.proposer.propose(scene, category, placeable, DRAWS * count, rng, allowed, coming)
        likely = _nearest(scene, self.obj, placeable, found, count - count // SHIFTED)
        places = np.concatenate([likely.places, _shifted(scene, self.obj, placeable.half, found.places[:count], rng)])
        both = Proposals(np.concatenate([likely.support, found.support[:count]]), places)
        return _nearest(scene, self.obj, placeable, both, count)


def _nearest(scene: ObservedScene, obj: int, placeable: Placeable, found: Proposals, count: int) -> Proposals:
    """So many proposals: those beside an object first, then the nearest; else in their order."""
    gaps = np.maximum(aside(scene, obj, placeable.half, found.places), BESIDE)
    order = np.argsort(gaps, kind="stable")[:count]
    return Proposals(found.support[order], found.places[order])


def _shifted(
    scene: ObservedScene, obj: int, half: NDArray[np.float64], places: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Places (T, 4) shifted, as high and turned as they are, to anywhere along the sides of an object."""
    count, yaw, own = len(places), float(scene.yaw[obj]), scene.half[obj, :2]
    reach = own + turned_reach(half, places[:, 3] - yaw)
    axis, side = rng.integers(2, size=count), rng.choice([-1.0, 1.0], size=count)
    local, each = rng.uniform(-1, 1, (count, 2)) * own, np.arange(count)
    local[each, axis] = side * (reach[each, axis] + rng.uniform(0, BESIDE, count))
    axes = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    return np.column_stack([scene.center[obj, :2] + local @ axes, places[:, 2:]])


def aside(
    scene: ObservedScene, obj: int, half: NDArray[np.float64], places: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Gaps (T,) between the footprints of an object and of another at places (T, 4), metres; at other heights more.

    The other's half extents are ``half`` (3,); they share a height if a quarter of the lower one's is common to both,
    else :data:`APART` is added.
    """
    low, high = scene.center[obj, 2] - scene.half[obj, 2], scene.center[obj, 2] + scene.half[obj, 2]
    shared = np.minimum(high, places[:, 2] + 2 * half[2]) - np.maximum(low, places[:, 2])
    gap = footprint_gap(scene.center[obj], scene.half[obj], float(scene.yaw[obj]), places, half)
    return gap + APART * (shared < SHARED * 2 * min(half[2], scene.half[obj, 2]))
