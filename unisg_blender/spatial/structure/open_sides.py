"""Places that are open to a side: where they end, and which are rooms at all."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.arrays import Bools
from ...geometry.column_raster import Grid, cells_on
from ...geometry.mask_outline import components, grown
from .looks import LOW, Look

CLOSED_RIM, OPEN_RIM = 0.12, 0.4
"""Share of a place's rim that is open to the floor around it: up to the first it is a room; from the second on it is a
corner between walls; in between it is a room if it is roofed, or ends at a parapet, or where it is narrow."""

NECK = 0.55
"""Half the width in metres of a doorway without a lintel, at most: there a room ends."""

PORCH_NECK = 1.0
"""The same of one behind which a porch is: what is beyond has no roof, and goes on to the open floor around."""

STRETCH = 0.3
"""Metres that such a porch reaches away from walls, at least: less is the ragged edge of cells."""

TOLD = 4
"""Cells to half of such a doorway, at least: where a scene is scanned more coarsely, it cannot be told."""

CORNER = 1.5
"""Times half a doorway's width that the corners of a room are away from where it is wide."""

MARGIN = 3.0
"""Metres around a place within which it may end."""


def closed_off(look: Look, at: tuple[int, int], mask: Bools, grid: Grid) -> list[tuple[tuple[int, int], Bools]]:
    """A place of a look, which begins at the cell ``at``, as far as parapets and doorways let it; none for a corner.

    Where walls are on most sides only, how far a place reaches on the open one is told by no more than how many of the
    directions meet a wall: its end there is ragged. It is moved to where the floor is parted by low walls, or is as
    narrow as a doorway.
    """
    wide = round(MARGIN / grid.cell)
    first = max(at[0] - wide, 0), max(at[1] - wide, 0)
    part = tuple(slice(start, place + size + wide) for start, place, size in zip(first, at, mask.shape, strict=True))
    floor, walls = look.floor[part], grown(look.walls[part])
    own = np.zeros(floor.shape, bool)
    own[at[0] - first[0] :, at[1] - first[1] :][: mask.shape[0], : mask.shape[1]] = mask
    if _open_share(floor, walls, own) > CLOSED_RIM:
        window = grid.window((look.first[0] + first[0], look.first[1] + first[1]), (floor.shape[0], floor.shape[1]))
        low = window.mask(cells_on(look.cuts[LOW][0], window)[0])
        found = _within_necks(floor & ~look.walls[part] & ~low, own, NECK / grid.cell)
        if found:
            return [(first, inner) for inner in found]
    places = []
    for inner in _without_porches(floor, look.walls[part], own, look.roofed[part], grid.cell):
        share = _open_share(floor, walls, inner)
        roofed = (look.roofed[part] & inner).sum() > 0.5 * inner.sum()
        if share <= CLOSED_RIM or (share <= OPEN_RIM and roofed):
            places.append((first, inner))
    return places


def _open_share(floor: Bools, walls: Bools, place: Bools) -> float:
    """The share of a place's rim that is open to the floor around it."""
    rim = grown(place) & ~place
    return float((rim & floor & ~walls).sum() / max(rim.sum(), 1))


def _without_porches(floor: Bools, walls: Bools, own: Bools, roofed: Bools, cell: float) -> list[Bools]:
    """What is left of a place without the stretches that belong, by a neck between walls, to the open floor beyond.

    A porch is a part of the floor around that walls happen to be beside: from there to the place it is as narrow as a
    doorway, it has no roof, and its own rim is open. An alcove, a bay or an arm of a room ends at walls: all of it is
    the place.
    """
    from scipy.ndimage import distance_transform_edt

    radius, free = PORCH_NECK / cell, floor & ~walls
    if radius < TOLD:
        return [own]
    wide: Any = distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1]
    core, count = components(wide > radius)
    size, mine = np.bincount(core.reshape(-1), minlength=count + 1), np.bincount(core[own], minlength=count + 1)
    around = mine <= 0.5 * size
    around[0] = False
    if not around.any():
        return [own]
    away, nearest = distance_transform_edt(core == 0, return_indices=True)
    beyond = own & free & ~roofed & (away <= radius + 1) & around[core[tuple(nearest)]]
    number, _ = components(beyond)
    left = own.copy()
    for stretch in np.unique(number[beyond & (wide > STRETCH / cell)]).tolist():
        if _open_share(floor & ~own, grown(walls), number == stretch) > CLOSED_RIM:
            left &= number != stretch
    if (left == own).all():
        return [own]
    number, _ = components(left)
    return [np.asarray(number == part) for part in np.unique(number[left & (wide > NECK / cell)])]


def _within_necks(floor: Bools, own: Bools, radius: float) -> list[Bools]:
    """The parts of a floor between its necks that are mostly ``own``, and do not go on to where nothing is known."""
    from scipy.ndimage import distance_transform_edt

    wide: Any = distance_transform_edt(np.pad(floor, 1))
    core, count = components(wide[1:-1, 1:-1] > radius)
    size = np.bincount(core.reshape(-1), minlength=count + 1)
    mine = np.bincount(core[own], minlength=count + 1)
    rim = np.concatenate([core[[0, -1]].reshape(-1), core[:, [0, -1]].reshape(-1)])
    chosen = np.flatnonzero((mine > 0.5 * size) & ~np.isin(np.arange(count + 1), rim))
    away, nearest = distance_transform_edt(core == 0, return_indices=True)
    near, found = core[tuple(nearest)], []
    for part in chosen[chosen > 0].tolist():
        number, _ = components(floor & (away <= CORNER * radius) & (near == part))
        found.append(np.asarray(number == number[core == part][0]))
    return found


def walled_share(look: Look, at: tuple[int, int], mask: Bools) -> float:
    """The share of the rim of a place of a look, which begins at the cell ``at``, that is at walls."""
    own = np.pad(mask, 1)
    rim = grown(own) & ~own
    i, j = np.nonzero(rim)
    i, j = i + at[0] - 1, j + at[1] - 1
    known = (i >= 0) & (j >= 0) & (i < look.walls.shape[0]) & (j < look.walls.shape[1])
    return float(grown(look.walls)[i[known], j[known]].sum() / max(len(i), 1))
