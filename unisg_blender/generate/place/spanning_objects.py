"""Objects that reach from one holder to another of its kind, as a girder does from wall to wall: where they fit."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...geometry.planar import footprint_gap, rotation
from ..observe.observed_scene import ObservedScene
from ..observe.prior_tables import PriorTables
from ..observe.support_priors import FAR_END

ALONG = np.linspace(-0.6, 0.6, 13)
"""Where along a holder it is tried, in half lengths: not at the ends, where the next wall touches its long side."""


def fit_for(category: int, half: Floats, scene: ObservedScene, allowed: Bools, tables: PriorTables) -> Bools:
    """Those of the ``allowed`` holders (K,) that may hold an object of a category: all, unless it spans.

    Where what spans reaches across from none of them, all may.
    """
    found = reached(scene, allowed, half) if tables.spanning[category] else allowed
    return found if found.any() else allowed


def reaches(scene: ObservedScene, holders: Bools, half: Floats) -> bool:
    """Does an object of half extents (3,) reach across from any of the ``holders`` (K,)?"""
    return bool(reached(scene, holders, half).any())


def reached(scene: ObservedScene, allowed: Bools, half: Floats) -> Bools:
    """Those of the ``allowed`` holders (K,) from which one of half extents (3,) reaches another one of its kind."""
    found = np.zeros(len(allowed), bool)
    for holder in np.flatnonzero(allowed):
        others = np.flatnonzero(scene.category == scene.category[holder])
        places = _across(scene, int(holder), half)
        gaps = [
            footprint_gap(scene.center[other], scene.half[other], float(scene.yaw[other]), places, half)
            for other in others[others != holder]
        ]
        found[holder] = bool(gaps) and bool(_between(np.min(gaps, axis=0)).any())
    return found


def _between(gap: Floats) -> Bools:
    return (gap >= FAR_END[0]) & (gap <= FAR_END[1])


def _across(scene: ObservedScene, holder: int, half: Floats) -> Floats:
    """Places (T, 4) of an object that stands out from either long side of a holder, longer side along the normal."""
    thin = int(scene.half[holder, :2].argmin())
    yaw = float(scene.yaw[holder])
    axes = rotation(yaw)[:2, :2].T
    normal, along = axes[thin], axes[1 - thin]
    out = scene.half[holder, thin] + half[:2].max()
    side, share = (part.ravel() for part in np.meshgrid([-1.0, 1.0], ALONG))
    middle = (
        scene.center[holder, :2] + np.outer(share * scene.half[holder, 1 - thin], along) + np.outer(side * out, normal)
    )
    turn = np.arctan2(normal[1], normal[0]) - (np.pi / 2 if half[1] > half[0] else 0.0)
    return np.column_stack([middle, np.zeros(len(middle)), np.full(len(middle), turn)])
