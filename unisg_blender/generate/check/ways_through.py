"""Does what was placed leave a way: a person gets everywhere in a room, and to its doors, as before."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.boxes import Boxes
from ...geometry.column_raster import Grid, cells_on, columns, slice_at
from ...geometry.mask_outline import components
from ...spatial.free_floor import PLACE
from ...spatial.structure.doorways import doorways
from ...spatial.structure.structure import Room

FINE, COARSE = 0.05, 0.1
LARGE, LARGEST = 1_000.0, 20_000.0
"""Metres of a cell; square metres of a room's rectangle from which on a coarser one will do, and from which on nobody
looks: no thing parts such a place."""

PERSON, POCKET = 0.25, PLACE
"""Metres from the middle of a person to what is beside; and the square metres of a place that is not to be cut off."""

STEP, HEAD, CUTS = 0.12, 1.8, 9
"""Metres over the floor between which something is in the way, and at how many heights it is cut."""


def in_the_way(room: Room, there: Floats, things: Sequence[Floats], spare: float = 0.0) -> list[int]:
    """Which of some things in a room cut a part of it, or a door, off; of several together the later ones.

    Parameters
    ----------
    room
        The room that they are in.
    there
        (M, 3, 3) all other triangles, world metres.
    things
        The triangles of each thing.
    spare
        Metres beside a person that a way has on both sides where it had so much before: what may just be passed is
        parted by a drawer that is open.
    """
    low, high = room.outline.min(axis=0), room.outline.max(axis=0)
    if (size := float(np.prod(high - low))) >= LARGEST:
        return []
    grid = Grid.around(low, high, FINE if size < LARGE else COARSE)
    middles = grid.middles_of(np.arange(grid.size))
    doors = _in_any(doorways((room,)), middles, room.floor + STEP).reshape(grid.shape)
    floor = room.contains(middles).reshape(grid.shape) | doors
    taken = _obstacles(there, grid, room.floor)
    halves = sorted({PERSON, PERSON + spare})
    clear = _clear(floor & ~taken, grid.cell)
    before, found = [components(clear > half) for half in halves], []
    for number, triangles in enumerate(things):
        more = taken | _obstacles(triangles, grid, room.floor)
        clear = _clear(floor & ~more, grid.cell)
        after = [components(clear > half)[0] for half in halves]
        if any(_parted(*known, now, doors, grid.cell) for known, now in zip(before, after, strict=True)):
            found.append(number)
        else:
            taken = more
    return found


def _parted(before: Ints, count: int, after: Ints, doors: Bools, cell: float) -> bool:
    """Did one of so many places fall into several that matter?"""
    return any(_parts(after[before == part], doors[before == part], cell) > 1 for part in range(1, count + 1))


def _parts(labels: Ints, at_door: Bools, cell: float) -> int:
    """Into how many places that matter one place fell: large ones, and those at a door."""
    size = np.bincount(labels) * cell**2
    doors = np.bincount(labels[at_door], minlength=len(size))
    return int(((size >= POCKET) | (doors > 0))[1:].sum())


def _clear(free: Bools, cell: float) -> Floats:
    """Metres from the middle of each free cell to the border of the next one that is taken."""
    from scipy.ndimage import distance_transform_edt

    away: Any = distance_transform_edt(np.pad(free, 1))
    return np.asarray((away[1:-1, 1:-1] - 0.5) * cell)


def _obstacles(triangles: Floats, grid: Grid, floor: float) -> Bools:
    """Cells (of the grid's shape) in which something is between a step and a head over the floor."""
    low, high = floor + STEP, floor + HEAD
    ends = triangles[:, :, 2].min(axis=1), triangles[:, :, 2].max(axis=1)
    near = triangles[(ends[0] <= high) & (ends[1] >= low)]
    over = columns(near, grid)
    found = [over.cell[(over.height >= low) & (over.height <= high)]]
    for height in np.linspace(low, high, CUTS):
        cut = near[(near[:, :, 2].min(axis=1) <= height) & (near[:, :, 2].max(axis=1) > height)]
        found.append(cells_on(slice_at(cut, float(height)), grid)[0])
    return grid.mask(np.concatenate(found))


def _in_any(boxes: Boxes, middles: Floats, height: float) -> Bools:
    """Which points (N, 2) are in one of some upright boxes."""
    points = np.column_stack([middles, np.full(len(middles), height)])
    found = np.zeros(len(points), bool)
    for center, axes, half in zip(boxes.center, boxes.axes, boxes.half, strict=True):
        found |= (np.abs((points - center) @ axes) <= half).all(axis=1)
    return found
