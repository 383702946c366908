"""Floors: at which heights people can stand, and which cells of each are in which room."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from heapq import heappop, heappush
from typing import Any

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.column_raster import Grid
from ...geometry.mask_outline import components
from .looks import MOSTLY, ROOF_SHARE, Look, holds_a_room, look_from, slices, smooth, walls_around
from .open_sides import closed_off, walled_share
from .region import Region
from .scan import HEADROOM, LEAST, LEVEL, FreeSpans, Scan, free_spans
from .stages import LARGER, stands_on
from .structure import TALLEST
from .sunk_blocks import in_sunk_blocks

LEAST_OPEN = 4.0
"""Square metres of an open place, at least."""

NARROW = 0.3
"""Half the width in metres of a room, at least: what is narrower is the inside of a wall."""

COARSEST = 1.5
"""Half the width in cells of a room, at least: less cannot be told in a scene that is scanned coarsely."""

CLEAR_SHARE = 0.3
"""Share of a room where people can stand, at least: there is a floor under a wardrobe too, and walls around it."""

FINE = 0.002
"""Metres to which heights are told apart where levels are counted."""

WALLED_ROOM, WALLED_SMALL = 0.5, 0.8
"""Share of the rim of a room that is at walls, at least, and of one that is smaller than an open place: others are
balconies, and what lies between trees."""

ROOF_WIDTH = 1.0
"""Half the width in metres of a roof, at least, that makes a terrace of the rest."""

HOLE = 4.0
"""Square metres up to which a hole in a floor is what stands there."""

RAISED = 0.3, 1.7
"""Metres of height over a floor beside it between which something small is a platform or a counter and no floor."""

PLATFORM = 6.0
"""Square metres up to which it counts as that."""

LEVEL_SHARE = 0.2
"""Share of all ground that an open place has, at least: flat spots of hills are no floor."""

MOST_LEVELS = 24


def find_regions(scan: Scan) -> list[Region]:
    """The rooms of all storeys; the largest open place that is level, where there is none, or all are things on it."""
    spans = free_spans(scan.building_columns, scan.up)
    stands = (spans.high - spans.low >= HEADROOM) & ~in_sunk_blocks(scan, spans)
    if scan.is_floor.any():
        stands &= scan.is_floor[spans.triangle]
    taken = np.full(scan.grid.shape, -np.inf)
    found: list[Region] = []
    levels = list(_levels(spans, stands, scan.grid))
    for look in _looks(scan, spans, stands, levels, taken):
        for region in _rooms_at(scan, spans, look, taken):
            if not _is_platform(region, found):
                found.append(region)
                held = taken[region.slices]
                held[region.mask] = region.floor
    area = sum(int(region.mask.sum()) for region in found)
    largest = max((int((stands & (np.abs(spans.low - level) <= LEVEL)).sum()) for level in levels[:1]), default=0)
    if found and largest < LARGER * area:
        return found
    place = _open_place(scan, spans, stands, levels)
    return place if not found or (place and stands_on(found, place[0], scan)) else found


def _looks(scan: Scan, spans: FreeSpans, stands: Bools, levels: list[float], taken: Floats) -> Iterator[Look]:
    """What is seen from some levels, that with most floor between walls first.

    From what is over or under floors that were ``taken`` in the meantime, as table tops are, nobody looks.
    """
    queue: list[tuple[int, int, Look | None]] = []
    on_level = [np.flatnonzero(stands & (np.abs(spans.low - level) <= LEVEL)) for level in levels]
    for number, here in enumerate(on_level):
        heappush(queue, (-len(here), number, None))
    while queue:
        _, number, look = heappop(queue)
        if look is not None:
            yield look
            continue
        cells = spans.cell[on_level[number]]
        free = cells[np.abs(taken.reshape(-1)[cells] - levels[number]) >= HEADROOM]
        look = look_from(scan, spans, stands, levels[number]) if holds_a_room(free, scan.grid) else None
        if look is not None:
            heappush(queue, (-int((look.within & look.standing).sum()), number, look))


def _levels(spans: FreeSpans, stands: Bools, grid: Grid) -> Iterator[float]:
    """Heights at which most can stand, the largest area first."""
    step, count = np.unique(np.round(spans.low[stands] / FINE).astype(np.int64), return_counts=True)
    height = step * FINE
    for _ in range(MOST_LEVELS):
        if count.sum() * grid.cell**2 < LEAST:
            return
        before = np.append(0, np.cumsum(count))
        last = np.searchsorted(height, height + LEVEL / 2, "right")
        sum_up = before[last] - before[:-1]
        best = int(sum_up.argmax())
        if sum_up[best] * grid.cell**2 < LEAST:
            return
        middle = np.searchsorted(before, before[best] + sum_up[best] / 2) - 1
        level = float(height[middle])
        yield level
        kept = np.abs(height - level) > LEVEL
        height, count = height[kept], count[kept]


def _terrace(mask: Bools, roofed: Bools, grid: Grid) -> Bools:
    """The large parts of a place that have no roof, if others have one: terraces and courts, not what is under a
    skylight; nothing where there is no roof at all, as a room without its ceiling."""
    from scipy.ndimage import distance_transform_edt

    none, cell = np.zeros(mask.shape, bool), grid.cell
    open_part = mask & ~roofed
    if open_part.sum() * cell**2 < LEAST_OPEN or (mask & roofed).sum() < ROOF_SHARE * mask.sum():
        return none
    wide: Any = distance_transform_edt(np.pad(mask & roofed, 1))
    if wide.max() * cell < ROOF_WIDTH:
        return none
    number, count = components(smooth(open_part))
    size = np.bincount(number.reshape(-1), minlength=count + 1) * cell**2
    return np.isin(number, np.flatnonzero(size[1:] >= LEAST_OPEN) + 1)


def _rooms_at(scan: Scan, spans: FreeSpans, look: Look, taken: Floats) -> list[Region]:
    """The rooms on a level, apart from what is over or under a floor that is known already."""
    free = np.abs(taken[slices(look.first, look.within.shape)] - look.level) >= HEADROOM
    found = []
    for where, ragged in _rooms(look.within & free & ~look.barrier, scan.grid):
        for at, mask in closed_off(look, where, ragged, scan.grid):
            found += _parts_of(scan, spans, look, at, mask)
    return found


def _parts_of(scan: Scan, spans: FreeSpans, look: Look, at: tuple[int, int], mask: Bools) -> list[Region]:
    """A place that begins at the cell ``at`` as a room, or as one with its terraces; none where nobody can stand."""
    part, found = slices(at, mask.shape), []
    if look.standing[part][mask].mean() < CLEAR_SHARE:
        return []
    terrace = _terrace(mask & look.standing[part], look.roofed[part], scan.grid)
    inner = _rooms(mask & ~terrace, scan.grid) if terrace.any() else [((0, 0), mask)]
    for parts, outdoors in ((inner, False), (_rooms(mask & terrace, scan.grid), True)):
        for (i, j), own in parts:
            corner, large = (at[0] + i, at[1] + j), own.sum() * scan.grid.cell**2 >= LEAST_OPEN
            enclosed = (look.seen[slices(corner, own.shape)][own] >= MOSTLY).mean() > 0.5
            walled = walled_share(look, corner, own) >= (WALLED_ROOM if large else WALLED_SMALL)
            indoors = bool(enclosed) and not outdoors and walled
            if indoors or large:
                found.append(_region(scan, spans, look, corner, own, indoors))
    return found


def _rooms(mask: Bools, grid: Grid) -> Iterator[tuple[tuple[int, int], Bools]]:
    """The connected parts of a mask that are as large and wide as a room, without the holes that furniture leaves.

    Each with the first cell of its own, smaller mask.
    """
    from scipy.ndimage import binary_fill_holes, distance_transform_edt, find_objects

    number, count = components(mask)
    size = np.bincount(number.reshape(-1), minlength=count + 1) * grid.cell**2
    windows = find_objects(number.astype(np.int32))
    rooms = []
    for part in np.flatnonzero(size[1:] >= LEAST) + 1:
        own = np.pad(number[windows[part - 1]] == part, 1)
        wide: Any = distance_transform_edt(own)
        if wide.max() * grid.cell >= NARROW and wide.max() >= COARSEST:
            rooms.append(int(part))
    others = np.isin(number, rooms)
    for part in rooms:
        window = windows[part - 1]
        own = number[window] == part
        holes, many = components(binary_fill_holes(own) & ~own)
        area = np.bincount(holes.reshape(-1), minlength=many + 1) * grid.cell**2
        held = np.bincount(holes.reshape(-1), others[window].reshape(-1), minlength=many + 1)
        small = (area <= HOLE) & (held == 0)
        small[0] = False
        yield (window[0].start, window[1].start), own | small[holes]


def _region(scan: Scan, spans: FreeSpans, look: Look, corner: tuple[int, int], mask: Bools, indoors: bool) -> Region:
    """A room whose mask begins at the cell ``corner`` of the look's part."""
    first = look.first[0] + corner[0], look.first[1] + corner[1]
    grid = scan.grid.window(first, (mask.shape[0], mask.shape[1]))
    lintel = look.level + look.lintel
    region = Region(mask, grid, first, look.level, np.inf, lintel, indoors, -1, -1, look.cuts)
    mine = look.here[region.over(spans.cell[look.here], scan.grid.shape[1])]
    roofed = mine[spans.high[mine] <= look.level + TALLEST]
    covered = len(roofed) > 0.5 * len(mine)
    low, high = (float(np.median(some)) if len(some) else look.level for some in (spans.low[mine], spans.high[roofed]))
    over = _commonest(scan.row[spans.over[roofed]]) if covered else -1
    under = _commonest(scan.row[spans.triangle[mine]])
    return replace(region, floor=low, ceiling=high if covered else np.inf, floor_row=under, ceiling_row=over)


def _commonest(rows: Ints) -> int:
    return int(np.bincount(rows).argmax()) if len(rows) else -1


def _is_platform(region: Region, floors: list[Region]) -> bool:
    """Is it a counter, a bed or a step: small, and beside or over a lower floor?"""
    from scipy.ndimage import binary_dilation

    if region.mask.sum() * region.grid.cell**2 > PLATFORM:
        return False
    beside = binary_dilation(np.pad(region.mask, 2), iterations=2)
    i, j = np.nonzero(beside)
    i, j = i + region.first[0] - 2, j + region.first[1] - 2
    low, high = RAISED
    for other in floors:
        if low <= region.floor - other.floor <= high:
            k, m = i - other.first[0], j - other.first[1]
            near = (k >= 0) & (m >= 0) & (k < other.mask.shape[0]) & (m < other.mask.shape[1])
            if other.mask[k[near], m[near]].any():
                return True
    return False


def _open_place(scan: Scan, spans: FreeSpans, stands: Bools, levels: list[float]) -> list[Region]:
    """The largest level place that is no room, if there is one."""
    largest: list[tuple[int, float, tuple[int, int], Bools]] = []
    for level in levels:
        here = stands & (np.abs(spans.low - level) <= LEVEL)
        largest += [
            (int(mask.sum()), level, at, mask) for at, mask in _rooms(scan.grid.mask(spans.cell[here]), scan.grid)
        ]
    ground = len(np.unique(spans.cell[spans.high - spans.low >= HEADROOM]))
    size, level, at, mask = max(largest, key=lambda place: place[0], default=(0, 0.0, (0, 0), np.zeros(0, bool)))
    if size < max(LEAST_OPEN / scan.grid.cell**2, LEVEL_SHARE * ground):
        return []
    here = np.flatnonzero(stands & (np.abs(spans.low - level) <= LEVEL))
    cuts, lintel = walls_around(scan, spans, here, level)
    empty = np.zeros((0, 0), bool)
    look = Look(level, (0, 0), empty, empty, empty, empty, empty, empty, np.zeros((0, 0), np.int64), here, lintel, cuts)
    return [_region(scan, spans, look, at, mask, False)]
