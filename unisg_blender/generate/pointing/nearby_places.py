"""The best places near a point, one apart from the other."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Floats, Ints
from ...geometry.planar import wrapped
from .place_map import PlaceMap

REACH, NEAR = 1.2, 0.3
"""Metres from a point within which places are near it, and over which being near counts as much as a nat or half."""

APART, TURNED = 0.25, np.radians(30)
"""Metres, or a turn, from which on a place is another one."""

MOST = 12
"""How many places near a point one can go through."""


def distances(found: PlaceMap, point: Floats) -> Floats:
    """Metres (N,) from what one points at, (3,), to the places; of what hangs as seen from above."""
    off = found.aim - point
    off[:, 2] = np.where(found.hangs, 0.0, off[:, 2])
    return np.asarray(np.linalg.norm(off, axis=1))


def appeal(log_density: Floats, away: Floats | float) -> Floats:
    """What makes a place the best one near a point: likely, and not far away."""
    return np.asarray(log_density - (away / NEAR) ** 2 / 2)


def best_near(found: PlaceMap, away: Floats, most: int = MOST, radius: float = 0.0) -> Ints:
    """Numbers of the places that fit among those ``away`` (N,) metres from a point, the best first.

    Each is apart from those before it. ``radius`` is that of the thing: so much farther away may it be.
    """
    near = np.flatnonzero(found.fits & (away < REACH + radius))
    near = near[np.argsort(-appeal(found.log_density[near], away[near]), kind="stable")]
    places = found.places[near]
    kept: list[int] = []
    while len(near) and len(kept) < most:
        kept.append(int(near[0]))
        apart = ((places[:, :3] - places[0, :3]) ** 2).sum(axis=1) >= APART**2
        apart |= np.abs(wrapped(places[:, 3] - places[0, 3])) >= TURNED
        near, places = near[apart], places[apart]
    return np.array(kept, np.int64)
