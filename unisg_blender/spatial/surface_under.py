"""Which surface an object stands on or in, by the meshes themselves: for sheets, terrain, houses of one mesh."""

from __future__ import annotations

import numpy as np

from ..geometry.surface_contact import bearing, column_ends, grid_places, heights
from .object_rows import Objects

SHARE = 0.5
"""Share of an object's footprint that is over a surface, at least, where the object stands on it or sunk in it."""


def surface_under(objects: Objects, subject: int, target: int, gap: float = 0.0) -> float | None:
    """Height of the target's highest surface on or in which the subject stands, metres; None if there is none.

    The surface reaches farther than the subject, lies under or goes through most of it, and is not above its middle,
    nor more than ``gap`` metres below its lowest point.
    """
    low, high = objects.low[subject].copy(), objects.high[subject].copy()
    size, other = (high - low)[:2], (objects.high[target] - objects.low[target])[:2]
    high[2], low[2] = (low[2] + high[2]) / 2, low[2] - gap
    if size.prod() >= other.prod() or (objects.low[target] > high).any() or (objects.high[target] < low).any():
        return None
    places = grid_places(low, high)
    shown = np.isfinite(column_ends(places, objects.triangles(subject))[:, 0]).any(axis=0)
    found = heights(places[shown], bearing(objects.triangles_within(target, low, high)))
    met = (found >= low[2]) & (found <= high[2])
    if not met.any() or met.any(axis=1).mean() < SHARE:
        return None
    return float(found[met].max())
