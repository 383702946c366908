"""Floors: at which heights people can stand, and which cells of each are in which room."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.column_raster import Grid, cells_on, enclosure
from ...geometry.mask_outline import components
from .scan import HEADROOM, FreeSpans, Scan, free_spans
from .structure import TALLEST

LEVEL = 0.12
"""Metres of height within which surfaces are one floor: rugs, thresholds, a little slope."""

LEAST, LEAST_OPEN = 1.0, 4.0
"""Square metres of a room, and of an open place, at least."""

NARROW = 0.3
"""Half the width in metres of a room, at least: what is narrower is the inside of a wall."""

EYE, ROUND, MOSTLY, FARTHEST = 1.4, 13, 10, 30.0
"""Walls are looked for at this height in metres in 16 directions: inside is where so many of them meet one, or so many
under a roof, within so many metres."""

CLEAR_SHARE = 0.3
"""Share of a room where people can stand, at least: there is a floor under a wardrobe too, and walls around it."""

ROOF_SHARE, ROOF_WIDTH = 0.2, 1.0
"""Share of a place that is roofed, and half the width of the roof in metres, at least, where the rest is a terrace: a
beam or a lamp is no roof."""

RAY = 2
"""Cells of the grid to a cell of the one in which walls are looked for: what is seen need not be told so finely."""

WALLED = 0.6
"""Share of the rim of a floor without a roof that is at walls, at least, where all of it is a room."""

HOLE = 4.0
"""Square metres up to which a hole in a floor is what stands there."""

RAISED = 0.3, 1.7
"""Metres of height over a floor beside it between which something small is a platform or a counter and no floor."""

PLATFORM = 6.0
"""Square metres up to which it counts as that."""

LEVEL_SHARE = 0.2
"""Share of all ground that an open place has, at least: flat spots of hills are no floor."""

MOST_LEVELS = 12


@dataclass(frozen=True, eq=False)
class Region:
    """A room as cells: bool ``mask`` of the grid's shape, heights of floor, ceiling (inf for none) and lintels, metres.

    ``cuts`` are the walls at some heights over the floor: segments (S, 2, 2) and the rows (S,) of their entities.
    """

    mask: Bools
    floor: float
    ceiling: float
    lintel: float
    indoors: bool
    floor_row: int
    ceiling_row: int
    cuts: dict[float, tuple[Floats, Ints]]


def find_regions(scan: Scan) -> list[Region]:
    """The rooms of all storeys; where there is none, the largest open place that is level."""
    spans = free_spans(scan.building_columns, scan.up)
    stands = spans.high - spans.low >= HEADROOM
    if scan.is_floor.any():
        stands &= scan.is_floor[spans.triangle]
    taken = np.full(scan.grid.shape, -np.inf)
    found: list[Region] = []
    levels = list(_levels(spans, stands, scan.grid))
    looks = [_look(scan, spans, stands, level) for level in levels]
    for look in sorted(looks, key=lambda look: -int((look.within & look.standing).sum())):
        for region in _rooms_at(scan, spans, look, taken):
            if not _is_platform(region, found, scan.grid):
                found.append(region)
                taken[region.mask] = region.floor
    return found or _open_place(scan, spans, stands, levels)


def _levels(spans: FreeSpans, stands: Bools, grid: Grid) -> Iterator[float]:
    """Heights at which most can stand, the largest area first."""
    low = np.sort(spans.low[stands])
    for _ in range(MOST_LEVELS):
        if len(low) * grid.cell**2 < LEAST:
            return
        count = np.searchsorted(low, low + LEVEL / 2, "right") - np.arange(len(low))
        best = int(count.argmax())
        level = float(np.median(low[best : best + count[best]]))
        if count[best] * grid.cell**2 < LEAST:
            return
        yield level
        low = low[np.abs(low - level) > LEVEL]


@dataclass(frozen=True, eq=False)
class Look:
    """What is seen from a level: bool masks of the grid's shape.

    Where one can stand on its floor (``standing``); where its floor, under furniture too, is ``within`` walls; what
    walls and lintels part (``barrier``). ``here`` (N,) are its free spans, ``seen`` counts in
    how many directions there is a wall.
    """

    level: float
    standing: Bools
    within: Bools
    barrier: Bools
    roofed: Bools
    seen: Ints
    here: Bools
    lintel: float
    cuts: dict[float, tuple[Floats, Ints]]


def _look(scan: Scan, spans: FreeSpans, stands: Bools, level: float) -> Look:
    grid, near = scan.grid, np.abs(spans.low - level) <= LEVEL
    here = stands & near
    floor = grid.mask(spans.cell[near] if not scan.is_floor.any() else spans.cell[near & scan.is_floor[spans.triangle]])
    ceiling = np.full(grid.size, np.inf)
    ceiling[spans.cell[here]] = spans.high[here]
    roofed = (ceiling <= level + TALLEST).reshape(grid.shape)
    cuts, lintel = _walls(scan, level, ceiling[np.isfinite(ceiling)])
    around = np.concatenate([cuts[EYE][0], cuts[lintel][0]])
    seen = np.zeros(grid.size, np.int64)
    cells = np.flatnonzero(floor)
    seen[cells] = enclosure(around, grid.middles[cells], RAY * grid.cell, FARTHEST)
    seen = seen.reshape(grid.shape)
    within = (seen >= ROUND) | (roofed & (seen >= MOSTLY))
    within = floor & (_smooth(within) | bool(scan.is_floor.any()))
    barrier = grid.mask(cells_on(cuts[lintel][0], grid)[0])
    if (floor & roofed).sum() < ROOF_SHARE * floor.sum():
        within |= _open_sided(floor, barrier)
    standing = grid.mask(spans.cell[here])
    return Look(level, standing, within, barrier, roofed, seen, here, lintel, cuts)


def _open_sided(floor: Bools, barrier: Bools) -> Bools:
    """Whole floors most of whose rim is at walls: the rest of it may be open, or of glass."""
    from scipy.ndimage import binary_dilation, binary_erosion

    number, count = components(floor & ~barrier)
    rim = (number > 0) & ~binary_erosion(number > 0)
    walled = rim & binary_dilation(barrier, iterations=2)
    length, closed = (np.bincount(number[mask], minlength=count + 1) for mask in (rim, walled))
    return (number > 0) & (closed > WALLED * length)[number]


def _terrace(mask: Bools, roofed: Bools, grid: Grid) -> Bools:
    """The large parts of a place that have no roof, if others have one: terraces and courts, not what is under a
    skylight; nothing where there is no roof at all, as a room without its ceiling."""
    from scipy.ndimage import distance_transform_edt

    wide: Any = distance_transform_edt(np.pad(mask & roofed, 1))
    if (mask & roofed).sum() < ROOF_SHARE * mask.sum() or wide.max() * grid.cell < ROOF_WIDTH:
        return np.zeros(mask.shape, bool)
    number, count = components(_smooth(mask & ~roofed))
    size = np.bincount(number.reshape(-1), minlength=count + 1) * grid.cell**2
    return np.isin(number, np.flatnonzero(size[1:] >= LEAST_OPEN) + 1)


def _rooms_at(scan: Scan, spans: FreeSpans, look: Look, taken: Floats) -> list[Region]:
    """The rooms on a level, apart from what is over or under a floor that is known already."""
    free = np.abs(taken - look.level) >= HEADROOM
    found = []
    for mask in _rooms(look.within & free & ~look.barrier, scan.grid):
        if look.standing[mask].mean() < CLEAR_SHARE:
            continue
        terrace = _terrace(mask & look.standing, look.roofed, scan.grid)
        for part in _rooms(mask & ~terrace, scan.grid) if terrace.any() else [mask]:
            indoors = bool((look.seen[part] >= MOSTLY).mean() > 0.5)
            found.append(_region(scan, spans, look, part, indoors))
        found += [_region(scan, spans, look, part, False) for part in _rooms(mask & terrace, scan.grid)]
    return found


def _walls(scan: Scan, level: float, ceilings: Floats) -> tuple[dict[float, tuple[Floats, Ints]], float]:
    """The cuts at some heights over a floor, and at which of them doors are closed by what is over them."""
    room = float(np.median(ceilings)) - level if len(ceilings) else 4.0
    cuts = {height: scan.cut(level + height) for height in (0.25, 1.0, EYE, 1.8)}
    wall = _length(cuts[EYE][0])
    for height in np.arange(min(room - 0.12, 3.5), 1.85, -0.15).round(3).tolist():
        cut = scan.cut(level + height)
        if _length(cut[0]) >= 0.6 * wall > 0:
            cuts[height] = cut
            return cuts, height
    return cuts, 1.8


def _length(segments: Floats) -> float:
    return float(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum())


def _smooth(mask: Bools) -> Bools:
    from scipy.ndimage import uniform_filter

    return np.asarray(uniform_filter(mask.astype(np.float32), 5) > 0.5)


def _rooms(mask: Bools, grid: Grid) -> Iterator[Bools]:
    """The connected parts of a mask that are as large and wide as a room, without the holes that furniture leaves."""
    from scipy.ndimage import binary_fill_holes, distance_transform_edt, find_objects

    number, count = components(mask)
    size = np.bincount(number.reshape(-1), minlength=count + 1) * grid.cell**2
    windows = find_objects(number.astype(np.int32))
    rooms = []
    for part in np.flatnonzero(size[1:] >= LEAST) + 1:
        own = np.pad(number[windows[part - 1]] == part, 1)
        wide: Any = distance_transform_edt(own)
        if wide.max() * grid.cell >= NARROW:
            rooms.append(int(part))
    others = np.isin(number, rooms)
    for part in rooms:
        window = windows[part - 1]
        own = number[window] == part
        holes, many = components(binary_fill_holes(own) & ~own)
        for hole in range(1, many + 1):
            inner = holes == hole
            if inner.sum() * grid.cell**2 <= HOLE and not (inner & others[window]).any():
                own |= inner
        whole = np.zeros(mask.shape, bool)
        whole[window] = own
        yield whole


def _region(scan: Scan, spans: FreeSpans, look: Look, mask: Bools, indoors: bool) -> Region:
    level, here = look.level, look.here
    mine = here & mask.reshape(-1)[spans.cell]
    roofed = mine & (spans.high <= level + TALLEST)
    covered = roofed.sum() > 0.5 * mine.sum()
    low, high = (float(np.median(some)) if len(some) else level for some in (spans.low[mine], spans.high[roofed]))
    over = _commonest(scan.row[spans.over[roofed]]) if covered else -1
    under = _commonest(scan.row[spans.triangle[mine]])
    return Region(
        mask, low, high if covered else np.inf, level + look.lintel, indoors, under, over, look.cuts
    )  # fmt: skip


def _commonest(rows: Ints) -> int:
    return int(np.bincount(rows).argmax()) if len(rows) else -1


def _is_platform(region: Region, floors: list[Region], grid: Grid) -> bool:
    """Is it a counter, a bed or a step: small, and beside or over a lower floor?"""
    from scipy.ndimage import binary_dilation

    if region.mask.sum() * grid.cell**2 > PLATFORM:
        return False
    beside = binary_dilation(region.mask, iterations=2)
    low, high = RAISED
    return any(low <= region.floor - other.floor <= high and (beside & other.mask).any() for other in floors)


def _open_place(scan: Scan, spans: FreeSpans, stands: Bools, levels: list[float]) -> list[Region]:
    """The largest level place that is no room, if there is one."""
    largest: list[tuple[int, float, Bools]] = []
    for level in levels:
        here = stands & (np.abs(spans.low - level) <= LEVEL)
        largest += [(int(mask.sum()), level, mask) for mask in _rooms(scan.grid.mask(spans.cell[here]), scan.grid)]
    ground = len(np.unique(spans.cell[spans.high - spans.low >= HEADROOM]))
    size, level, mask = max(largest, key=lambda place: place[0], default=(0, 0.0, np.zeros(0, bool)))
    if size < max(LEAST_OPEN / scan.grid.cell**2, LEVEL_SHARE * ground):
        return []
    return [_region(scan, spans, _look(scan, spans, stands, level), mask, False)]
