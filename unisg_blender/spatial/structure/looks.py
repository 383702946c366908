"""What is seen from a level at which people can stand: where its floor is, and which walls are around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.column_raster import Grid, cells_on, enclosure
from ...geometry.mask_outline import components, grown
from .beams import is_beam
from .scan import LEAST, LEVEL, FreeSpans, Scan
from .structure import TALLEST

EYE, ROUND, MOSTLY, FARTHEST, FAR_ROOFED = 1.4, 13, 10, 30.0, 150.0
"""Walls are looked for at this height in metres in 16 directions: inside is where so many of them meet one, or so many
under a roof, within so many metres, and under a roof within so many more."""

LEANING = -0.6
"""Upward part of the unit normal of what parts rooms over doors, at least: the underside of a roof does not."""

LONGER = 1.1
"""Times the length of a cut from which on the one below it is taken: the top of walls may be uneven."""

LOW = 0.25
"""Metres over a floor at which parapets are cut."""

RAY = 3
"""Cells of the grid to a cell of the one in which walls are looked for: what is seen need not be told so finely."""

BESIDE = 3.0
"""Metres around all walls within which a floor is looked at: what is farther out is outside."""

WALLED = 0.6
"""Share of the rim of a floor without a roof that is at walls, at least, where all of it is a room."""

ROOF_SHARE = 0.2
"""Share of a place that is roofed, at least, where the rest is a terrace: a beam or a lamp is no roof."""


@dataclass(frozen=True, eq=False)
class Look:
    """What is seen from a level: bool masks of the shape of a part of the grid, which begins at ``first``.

    Where its ``floor`` is, and where one can stand on it (``standing``); where it is ``within`` walls, under furniture
    too; what walls and lintels part (``barrier``), with the ``walls`` at the height of eyes. ``here`` are the numbers
    of its free spans, ``seen`` counts in how many directions there is a wall.
    """

    level: float
    first: tuple[int, int]
    floor: Bools
    standing: Bools
    within: Bools
    barrier: Bools
    walls: Bools
    roofed: Bools
    seen: Ints
    here: Ints
    lintel: float
    cuts: dict[float, tuple[Floats, Ints]]


def look_from(scan: Scan, spans: FreeSpans, stands: Bools, level: float) -> Look | None:
    """What is seen from a level; None where no walls are around it."""
    near = np.flatnonzero(np.abs(spans.low - level) <= LEVEL)
    here = near[stands[near]]
    cuts, lintel = walls_around(scan, spans, here, level)
    around = np.concatenate([cuts[EYE][0], cuts[lintel][0]])
    named = bool(scan.is_floor.any())
    under = near[scan.is_floor[spans.triangle[near]]] if named else near
    first, shape = _part(scan.grid, spans.cell[under], None if named else around)
    if 0 in shape:
        return None
    grid = scan.grid.window(first, shape)
    floor, standing, roofed = (
        cells_as_mask(spans.cell[some], scan.grid, first, shape)
        for some in (under, here, here[spans.high[here] <= level + TALLEST])
    )
    seen = _seen(floor, roofed, grid, around)
    within = (seen >= ROUND) | (roofed & (seen >= MOSTLY))
    within = floor & (smooth(within) | named)
    over = cuts[lintel][0]
    barrier = grid.mask(cells_on(over[~is_beam(over, cuts[EYE][0])], grid)[0])
    walls = barrier | grid.mask(cells_on(cuts[EYE][0], grid)[0])
    if (floor & roofed).sum() < ROOF_SHARE * floor.sum():
        within |= _open_sided(floor, barrier)
    return Look(level, first, floor, standing, within, barrier, walls, roofed, seen, here, lintel, cuts)


def holds_a_room(cells: Ints, grid: Grid) -> bool:
    """Are so many cells connected as a room has at least?"""
    if len(cells) * grid.cell**2 < LEAST:
        return False
    first, shape = _part(grid, cells, None)
    number, _ = components(cells_as_mask(cells, grid, first, shape))
    return bool(np.bincount(number.reshape(-1), minlength=2)[1:].max() * grid.cell**2 >= LEAST)


def _part(grid: Grid, cells: Ints, walls: Floats | None) -> tuple[tuple[int, int], tuple[int, int]]:
    """First cell and shape of the part of a grid that holds some cells, not far from walls (S, 2, 2), if given."""
    if not len(cells) or (walls is not None and not len(walls)):
        return (0, 0), (0, 0)
    i, j = np.divmod(cells, grid.shape[1])
    low, high = np.array([i.min(), j.min()]) - 1, np.array([i.max(), j.max()]) + 2
    if walls is not None:
        ends = walls.reshape(-1, 2)
        low = np.maximum(low, np.floor((ends.min(axis=0) - BESIDE - grid.origin) / grid.cell))
        high = np.minimum(high, np.ceil((ends.max(axis=0) + BESIDE - grid.origin) / grid.cell))
    low, high = np.maximum(low, 0).astype(int), np.minimum(high, grid.shape).astype(int)
    size = np.maximum(high - low, 0)
    return (int(low[0]), int(low[1])), (int(size[0]), int(size[1]))


def cells_as_mask(cells: Ints, grid: Grid, first: tuple[int, int], shape: tuple[int, int]) -> Bools:
    """Cells of a grid as a mask of a part of it."""
    i, j = np.divmod(cells, grid.shape[1])
    i, j = i - first[0], j - first[1]
    near = (i >= 0) & (j >= 0) & (i < shape[0]) & (j < shape[1])
    found = np.zeros(shape, bool)
    found[i[near], j[near]] = True
    return found


def slices(first: tuple[int, int], shape: tuple[int, ...]) -> tuple[slice, slice]:
    return slice(first[0], first[0] + shape[0]), slice(first[1], first[1] + shape[1])


def _seen(floor: Bools, roofed: Bools, grid: Grid, walls: Floats) -> Ints:
    """In how many directions walls are seen, told every few cells."""
    coarse, under = (
        padded.reshape(padded.shape[0] // RAY, RAY, -1, RAY).any(axis=(1, 3))
        for padded in (np.pad(mask, [(0, -size % RAY) for size in mask.shape]) for mask in (floor, roofed))
    )
    i, j = np.nonzero(coarse)
    points = (np.stack([i, j], axis=1) * RAY + RAY / 2) * grid.cell + grid.origin
    count = np.zeros(coarse.shape, np.int64)
    count[i, j] = enclosure(walls, points, RAY * grid.cell, np.where(under[i, j], FAR_ROOFED, FARTHEST))
    return count.repeat(RAY, axis=0).repeat(RAY, axis=1)[: floor.shape[0], : floor.shape[1]]


def _open_sided(floor: Bools, barrier: Bools) -> Bools:
    """Whole floors most of whose rim is at walls: the rest of it may be open, or of glass."""
    number, count = components(floor & ~barrier)
    rim = (number > 0) & grown(number == 0)
    walled = rim & grown(grown(barrier))
    length, closed = (np.bincount(number[mask], minlength=count + 1) for mask in (rim, walled))
    edge = np.concatenate([number[[0, -1]].reshape(-1), number[:, [0, -1]].reshape(-1)])
    whole = ~np.isin(np.arange(count + 1), edge)
    return (number > 0) & (whole & (closed > WALLED * length))[number]


def walls_around(
    scan: Scan, spans: FreeSpans, here: Ints, level: float
) -> tuple[dict[float, tuple[Floats, Ints]], float]:
    """The cuts at some heights over a floor, and at which of them doors are closed by what is over them."""
    cuts = {height: scan.cut(level + height) for height in (LOW, 1.0, EYE, 1.8)}
    room, wall = _height(scan, spans, here, cuts[EYE][0]) - level, _length(cuts[EYE][0])
    best, lintel = 1.8, cuts[1.8]
    for height in np.arange(min(room - 0.12, 3.5), 1.85, -0.15).round(3).tolist():
        cut = scan.cut(level + height, LEANING)
        if best > 1.8 and _length(cut[0]) < LONGER * _length(lintel[0]):
            break
        if _length(cut[0]) >= 0.6 * wall > 0:
            best, lintel = height, cut
    return (cuts | {best: lintel} if best > 1.8 else cuts), best


def _height(scan: Scan, spans: FreeSpans, here: Ints, walls: Floats) -> float:
    """The height of the ceiling that is over most of what walls are around; inf where hardly any of it has one."""
    if not len(here) or not len(walls):
        return np.inf
    low, high = walls.min(axis=(0, 1)), walls.max(axis=(0, 1))
    i, j = np.divmod(spans.cell[here], scan.grid.shape[1])
    x, y = ((axis + 0.5) * scan.grid.cell + start for axis, start in zip((i, j), scan.grid.origin, strict=True))
    over = spans.high[here[(x >= low[0]) & (x <= high[0]) & (y >= low[1]) & (y <= high[1])]]
    roofed = over[np.isfinite(over)]
    return float(np.median(roofed)) if len(roofed) > ROOF_SHARE * len(over) else np.inf


def _length(segments: Floats) -> float:
    return float(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum())


def smooth(mask: Bools) -> Bools:
    """The cells (I, J) around which more than half of five by five are in the mask."""
    from scipy.ndimage import uniform_filter

    return np.asarray(uniform_filter(mask.astype(np.float32), 5) > 0.5)
