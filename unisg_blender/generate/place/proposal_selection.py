"""From proposals to a place: settled on their supports, checked, and the first that fits is taken."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Bools, Floats
from ..observe.support_priors import RESTS
from ..propose.proposer import Proposals
from .growing_scene import GrowingScene, Target
from .settle_geometry import fitting, nearest_support, rest, search

SEARCHED = 4
"""Supports whose whole surface is searched when no proposal fits."""


@dataclass(frozen=True, eq=False)
class FoundPlace:
    """A place (4,) for a target on an object (-1: the ground), whether it ``fits``, and how it was found; ``cuts``
    where it fits nowhere but where it would cut the floor."""

    target: Target
    support: int
    place: Floats
    fits: bool = True
    draws: int = 1
    searched: bool = False
    cuts: bool = False


def first_fitting(scene: GrowingScene, target: Target, batches: Iterable[Proposals], keep_holders: bool) -> FoundPlace:
    """The first proposal that fits after settling, else the free place nearest to the first of all on each support.

    With ``keep_holders`` what hangs on walls is held by the very wall that was proposed, see :func:`nearest_holders`.
    """
    draws, seen, cuts = 0, [], False
    for drawn in batches:
        proposals = drawn if keep_holders else nearest_holders(scene, target, drawn)
        settled, good = settle(scene, target, proposals)
        best = scene.ways.best(target.placeable, settled.places, good)
        if best >= 0:
            return FoundPlace(target, int(settled.support[best]), settled.places[best], draws=draws + best + 1)
        cuts |= bool(good.any())
        draws += len(good)
        seen.append(proposals)
    supports = np.concatenate([proposals.support for proposals in seen])
    places = np.concatenate([proposals.places for proposals in seen])
    _, first = np.unique(supports, return_index=True)
    for row in np.sort(first)[:SEARCHED]:
        support = scene.support(target.category, int(supports[row]))
        found = search(target.placeable, places[row], target.category, support, scene.space, scene.ways)
        if found is not None:
            return FoundPlace(target, support.obj, found, draws=draws, searched=True)
    return FoundPlace(target, int(supports[0]), places[0], fits=False, draws=draws, cuts=cuts)


def settle(scene: GrowingScene, target: Target, proposals: Proposals) -> tuple[Proposals, Bools]:
    """The proposals after settling, and which of them (T,) fit."""
    places, good = proposals.places.copy(), np.zeros(len(proposals.places), bool)
    for obj in np.unique(proposals.support):
        mine, support = proposals.support == obj, scene.support(target.category, int(obj))
        places[mine] = rest(target.placeable, places[mine], support, scene.space)
        good[mine] = fitting(target.placeable, places[mine], target.category, support, scene.space)
    return Proposals(proposals.support, places), good


def nearest_holders(scene: GrowingScene, target: Target, proposals: Proposals) -> Proposals:
    """The proposals with the nearest holder where something holds them by its side: which of two walls may be open.

    The model chooses the holder before the place.
    """
    holder, kinds = proposals.support.copy(), scene.observed.category
    for obj in np.unique(holder[holder >= 0]):
        alike = np.flatnonzero(kinds == kinds[obj])
        if scene.support(target.category, int(obj)).contact != RESTS and len(alike) > 1:
            mine = np.flatnonzero(proposals.support == obj)
            supports = [scene.support(target.category, int(other)) for other in alike]
            holder[mine] = alike[nearest_support(target.placeable, proposals.places[mine], supports, scene.space)]
    return Proposals(holder, proposals.places)
