"""Surfaces: the level surfaces of an object on which others can stand, such as those of a shelf or a trolley."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..geometry.arrays import Floats
from ..geometry.boxes import Boxes, part_bottoms, part_tops, reach
from .supports import CONTACT

MOST = 8
"""Surfaces kept of one object, the largest ones."""

SHARE = 0.12
"""A level that has less than this share of the largest one's area is an edge and no surface."""

SAME = 0.01
"""Metres in height within which surfaces make one surface."""

OPEN = 2.0
"""Metres of headroom told where nothing of the object itself is above."""


def support_surfaces(parts: Boxes, bottom: float) -> Floats:
    """The surfaces of an object (S, 3), lowest first: height above its bottom, area (m2) and headroom, metres.

    Headroom is the clear height up to the next part of the object that covers a quarter of the surface.
    """
    if not len(parts.center):
        return np.zeros((0, 3))
    tops, lows = part_tops(parts), part_bottoms(parts)
    far = reach(parts)[:, :2]
    flat, each = np.abs(parts.axes[:, 2, :]).argmax(axis=1), np.arange(len(tops))
    area = 4 * (parts.half[each, (flat + 1) % 3] * parts.half[each, (flat + 2) % 3])
    order = np.argsort(tops, kind="stable")
    rising = tops[order]
    starts = np.append(0, np.flatnonzero(rising[1:] - rising[:-1] > SAME) + 1)
    total = np.add.reduceat(area[order], starts)
    levels = pairwise([*starts.tolist(), len(order)])
    largest = np.array([order[start:stop][area[order[start:stop]].argmax()] for start, stop in levels])
    kept = np.flatnonzero(total >= SHARE * total.max())
    kept = np.sort(kept[np.argsort(-total[kept], kind="stable")[:MOST]])
    rooms = [_headroom(part, tops, lows, parts.center[:, :2], far) for part in largest[kept]]
    return np.column_stack([tops[largest[kept]] - bottom, total[kept], rooms])


def _headroom(
    part: int, tops: Floats, lows: Floats, middle: Floats,
    reach: Floats,
) -> float:  # fmt: skip
    right, left = middle + reach, middle - reach
    over = np.minimum(right[part], right) - np.maximum(left[part], left)
    covered = over.clip(min=0).prod(axis=1) > reach[part].prod()  # a quarter of the four quarters
    above = covered & (lows > tops[part] - 1e-6) & (tops > tops[part] + SAME)
    return float(min((lows[above] - tops[part]).min(initial=OPEN), OPEN))


def surface_at(surfaces: Floats, height: float) -> int:
    """Which surface (S, 3) something stands on whose bottom is at a height above the object's bottom; -1 for none."""
    if not len(surfaces):
        return -1
    off = np.abs(surfaces[:, 0] - height)
    best = int(off.argmin())
    return best if off[best] <= CONTACT else -1
