"""Reference objects, from which one can tell where others are, such as an operating table or a sofa; they come first.

A category is a reference for another as far as the other's places spread less in its frame than
in the room: the logarithm of the ratio of the spreads, nats, times how often the two
are found together. Reference objects are chosen greedily by what they add.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np

from ...geometry.arrays import Floats
from ...geometry.planar import rotate
from ...spatial.objects import SceneObjects

FEWEST = 12
"""Pairs that a spread is measured from, at least."""

GAIN = 1.0
"""Nats a scene that a further reference object adds at least."""

Offsets = dict[tuple[int, int], list[Floats]]


def find_reference_objects(scenes: Iterable[SceneObjects], vocabulary: Sequence[str]) -> list[str]:
    """The reference categories of what stands on the floor, the most telling one first."""
    offsets: Offsets = defaultdict(list)
    count = 0
    for objects in scenes:
        _collect(objects, offsets)
        count += 1
    spread = {key: _spread(values) for key, values in offsets.items() if len(values) >= FEWEST}
    gains: dict[int, dict[int, float]] = defaultdict(dict)
    for (reference, other), width in spread.items():
        if reference >= 0 and (-1, other) in spread and spread[-1, other] > width:
            told = np.log(spread[-1, other] / width) * len(offsets[reference, other]) / count
            gains[reference][other] = float(told)
    return [vocabulary[number] for number in _greedy(gains)]


def _collect(objects: SceneObjects, offsets: Offsets) -> None:
    """Add where the floor's objects are in the room (-1, category), and from those that are alone of their kind."""
    held = np.flatnonzero(objects.support >= 0)
    on_floor = held[objects.support[objects.support[held]] < 0]
    rows = on_floor[(objects.category[on_floor] >= 0) & (objects.half[on_floor].max(axis=1) > 0)]
    if not len(rows):
        return
    kind, place, yaw = objects.category[rows], objects.center[rows, :2], objects.yaw[rows]
    middle = objects.center[objects.support[rows[0]], :2]
    for number, offset in zip(kind.tolist(), place - middle, strict=True):
        offsets[-1, number].append(offset)
    known, times = np.unique(kind, return_counts=True)
    for reference in known[times == 1].tolist():
        row = int(np.flatnonzero(kind == reference)[0])
        seen = rotate(place - place[row], -yaw[row])
        for other in np.flatnonzero(np.arange(len(rows)) != row):
            offsets[reference, int(kind[other])].append(seen[other])


def _spread(values: list[Floats]) -> float:
    """Geometric mean of the standard deviations along the two principal axes, metres, a centimetre at least."""
    covariance = np.cov(np.array(values).T) + 1e-4 * np.eye(2)
    return float(np.linalg.det(covariance) ** 0.25)


def _greedy(gains: dict[int, dict[int, float]]) -> list[int]:
    """Categories in the order in which each adds most to those before."""
    chosen: list[int] = []
    told: dict[int, float] = defaultdict(float)
    while True:
        added = {
            reference: sum(max(gain - told[other], 0.0) for other, gain in of.items())
            for reference, of in gains.items()
            if reference not in chosen
        }
        best = max(added, key=lambda reference: (added[reference], -reference), default=-1)
        if best < 0 or added[best] < GAIN:
            return chosen
        chosen.append(best)
        for other, gain in gains[best].items():
            told[other] = max(told[other], gain)
