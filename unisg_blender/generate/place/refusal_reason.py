"""Why an object found no place, for whoever has to make room."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Floats
from ..observe.placeable import Placeable
from ..observe.support_priors import RESTS
from .free_space import FreeSpace
from .settle_geometry import OUTSIDE, Support, rest

NO_PLACE = "no free place was found"
"""Begins every note of an object that was not placed, or not moved."""

CUTS_FLOOR = f"{NO_PLACE}: wherever there is room, it would cut the floor into parts that nobody can reach"


def why_not(
    placeable: Placeable, place: Floats, category: int, support: Support, name: str, space: FreeSpace
) -> str:  # fmt: skip
    """The note of an object for which no place was found.

    Parameters
    ----------
    placeable, category
        What was to be placed.
    place
        (4,) x, y, z and yaw, where it was wanted first.
    support, name
        What should hold it; "" for the ground.
    space
        What is taken up.
    """
    where = f"on {name}" if name else "there"
    if support.is_slope:
        return f"{NO_PLACE}: {name} is tilted, nothing of it is level"
    if support.contact == RESTS and not support.floor and len(support.tops.top):
        room = np.sort(support.tops.half, axis=1)
        if not (np.sort(placeable.half[:2]) <= room).all(axis=1).any():
            return f"{NO_PLACE}: it is larger than what is level of {name}"
    settled = rest(placeable, place[None], support, space)
    if support.indoors(space) and (space.outside(placeable, settled) > OUTSIDE).all():
        return f"{NO_PLACE}: {where} it would reach out of the room"
    return f"{NO_PLACE}: other things are in the way {where}"
