"""Triangles seen along the vertical lines through a grid, and cut by level planes: exact, with numpy alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .arrays import Bools, Floats, Ints
from .surface_contact import Triangles

AT_ONCE = 2_000_000
"""Cells that are worked on together."""

ALIKE = 1e-5
"""Metres within which places in a column may be in the order of their triangles."""

EDGE = 1e-6
"""Share of a cell by which triangles are widened, so that no line slips through between neighbours."""


@dataclass(frozen=True)
class Grid:
    """Square cells seen from above: ``origin`` (2,) metres is the lowest corner, ``shape`` counts cells along x and y.

    Cells are numbered along y first: ``i * shape[1] + j``.
    """

    origin: tuple[float, float]
    cell: float
    shape: tuple[int, int]

    @staticmethod
    def around(low: Floats, high: Floats, cell: float, margin: int = 2) -> Grid:
        """The grid that covers a rectangle, with some cells around it."""
        count = np.ceil((high - low) / cell).astype(int) + 2 * margin
        origin = low - margin * cell
        return Grid((float(origin[0]), float(origin[1])), cell, (int(count[0]), int(count[1])))

    def window(self, first: tuple[int, int], shape: tuple[int, int]) -> Grid:
        """The part of the grid that begins at the cell ``first`` (i, j)."""
        origin = self.origin[0] + first[0] * self.cell, self.origin[1] + first[1] * self.cell
        return Grid(origin, self.cell, shape)

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.shape[0] * self.shape[1]

    def middles_of(self, cells: Ints) -> Floats:
        """Middles of some cells, (N, 2) metres."""
        return (np.stack(np.divmod(cells, self.shape[1]), axis=1) + 0.5) * self.cell + self.origin

    def at(self, points: Floats) -> Ints:
        """The cell that each point (N, 2) is in, -1 outside."""
        place = np.floor((points - self.origin) / self.cell).astype(np.int64)
        inside = ((place >= 0) & (place < self.shape)).all(axis=1)
        return np.where(inside, place[:, 0] * self.shape[1] + place[:, 1], -1)

    def mask(self, cells: Ints) -> Bools:
        """bool of ``shape``: True at these cells."""
        found = np.zeros(self.size, bool)
        found[cells] = True
        return found.reshape(self.shape)


@dataclass(frozen=True, eq=False)
class Crossings:
    """C places where vertical lines through the middles of cells meet triangles, by cell and from below.

    ``cell``, ``triangle`` int64 (C,), ``height`` (C,) metres.
    """

    cell: Ints
    height: Floats
    triangle: Ints

    def take(self, rows: NDArray[np.integer] | Bools) -> Crossings:
        """Some of the places."""
        return Crossings(self.cell[rows], self.height[rows], self.triangle[rows])


def columns(triangles: Triangles, grid: Grid) -> Crossings:
    """Where the vertical lines through a grid's middles meet triangles (M, 3, 3)."""
    found = [_scanned(triangles, part, grid) for part in _portions(triangles, grid)]
    cell, height, triangle = (np.concatenate([np.zeros(0, kind), *parts]) for kind, parts in zip(
        (np.int64, np.float64, np.int64), zip(*found, strict=True) if found else ((), (), ()), strict=True
    ))  # fmt: skip
    order = _from_below(cell, height, grid.size)
    return Crossings(cell[order], height[order], triangle[order])


def _from_below(cell: Ints, height: Floats, cells: int) -> Ints:
    """The order by cell, then height, then entry: one number is sorted for all three, where they fit into one."""
    count = (len(cell) - 1).bit_length()
    steps = 2 ** (62 - count - cells.bit_length())
    size = float(np.ptp(height)) if len(height) else 0.0
    if not size <= ALIKE * steps:
        return np.lexsort((height, cell))
    level = ((height - height.min()) * ((steps - 1) / max(size, ALIKE))).astype(np.int64) if len(height) else cell
    key = ((cell * steps + level) << count) | np.arange(len(cell))
    key.sort()
    return key & (2**count - 1)


def _portions(triangles: Triangles, grid: Grid) -> Iterator[Ints]:
    """Numbers of triangles that could cover a cell's middle, as many at a time as are worked on together."""
    one, two, three = (triangles[:, corner, :2] for corner in range(3))
    low, high = np.minimum(np.minimum(one, two), three), np.maximum(np.maximum(one, two), three)
    first = np.ceil((low - grid.origin) / grid.cell - 0.5 - EDGE).clip(0)
    last = np.floor((high - grid.origin) / grid.cell - 0.5 + EDGE).clip(max=np.array(grid.shape) - 1)
    extent = (last - first + 1).clip(0)
    count = extent[:, 0] * extent[:, 1]
    chosen = np.flatnonzero(count > 0)
    bounds = np.cumsum(count[chosen]) // AT_ONCE
    yield from np.split(chosen, np.flatnonzero(np.diff(bounds)) + 1) if len(chosen) else ()


def _scanned(triangles: Triangles, part: Ints, grid: Grid) -> tuple[Ints, Floats, Ints]:
    """Cells, heights and triangles of a portion, line after line along x, cell after cell."""
    corner = triangles[part].astype(np.float64)
    corner[:, :, :2] = (corner[:, :, :2] - grid.origin) / grid.cell - 0.5  # cells' middles are whole numbers now
    first = np.ceil(corner[:, :, 1].min(axis=1) - EDGE).clip(0).astype(np.int64)
    last = np.floor(corner[:, :, 1].max(axis=1) + EDGE).clip(max=grid.shape[1] - 1).astype(np.int64)
    line, j = _ranges(first, last)
    left, right = np.full(len(j), np.inf), np.full(len(j), -np.inf)
    for start, stop in ((0, 1), (1, 2), (2, 0)):
        a, b = corner[line, start, :2], corner[line, stop, :2]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (j - a[:, 1]) / (b[:, 1] - a[:, 1])
        share = np.where(np.abs(b[:, 1] - a[:, 1]) < EDGE, np.nan, share)
        on = (share >= -EDGE) & (share <= 1 + EDGE)
        x = np.where(on, a[:, 0] + share * (b[:, 0] - a[:, 0]), np.nan)
        left, right = np.fmin(left, x), np.fmax(right, x)
    left, right = left.clip(-1, grid.shape[0]), right.clip(-2, grid.shape[0])
    run, i = _ranges(
        np.ceil(left - EDGE).clip(0).astype(np.int64),
        np.floor(right + EDGE).clip(max=grid.shape[0] - 1).astype(np.int64),
    )
    line, j = line[run], j[run]
    one, two = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    kept = np.abs(area[line]) > EDGE**2
    line, i, j = line[kept], i[kept], j[kept]
    step = np.stack([i, j], axis=1) - corner[line, 0, :2]
    u = (step[:, 0] * two[line, 1] - step[:, 1] * two[line, 0]) / area[line]
    v = (one[line, 0] * step[:, 1] - one[line, 1] * step[:, 0]) / area[line]
    height = corner[line, 0, 2] + u * one[line, 2] + v * two[line, 2]
    return i * grid.shape[1] + j, height, part[line]


def _ranges(first: Ints, last: Ints) -> tuple[Ints, Ints]:
    """All whole numbers from ``first`` to ``last`` (K,): of which entry each is, and the numbers."""
    count = (last - first + 1).clip(0)
    entry = np.repeat(np.arange(len(count)), count)
    return entry, first[entry] + np.arange(len(entry)) - np.repeat(np.cumsum(count) - count, count)


def slice_at(triangles: Triangles, height: float) -> Floats:
    """Where a level plane cuts triangles (M, 3, 3) that have corners on both sides: segments (M, 2, 2), metres."""
    above = triangles[:, :, 2] > height
    corner = triangles.astype(np.float64)
    lonely = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    each = np.arange(len(triangles))
    apex = corner[each, lonely]
    ends = []
    for step in (1, 2):
        other = corner[each, (lonely + step) % 3]
        share = (height - apex[:, 2]) / (other[:, 2] - apex[:, 2])
        ends.append(apex[:, :2] + share[:, None] * (other - apex)[:, :2])
    return np.stack(ends, axis=1)


def cells_on(segments: Floats, grid: Grid) -> tuple[Ints, Ints]:
    """Cells that segments (S, 2, 2) run through, and the segment of each; neighbours share a corner at least."""
    points, entry = _along(segments, grid.cell)
    cell = grid.at(points)
    return cell[cell >= 0], entry[cell >= 0]


def _along(segments: Floats, cell: float) -> tuple[Floats, Ints]:
    """Points (P, 2) along segments, two to a cell, and the segment of each."""
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    count = np.ceil(2 * length / cell).astype(np.int64) + 1
    entry = np.repeat(np.arange(len(count)), count)
    share = (np.arange(len(entry)) - np.repeat(np.cumsum(count) - count, count)) / np.maximum(count - 1, 1)[entry]
    return segments[entry, 0] + share[:, None] * (segments[entry, 1] - segments[entry, 0]), entry


def enclosure(segments: Floats, points: Floats, cell: float, farthest: Floats, directions: int = 16) -> Ints:
    """In how many of so many level directions each point (N, 2) sees one of the segments (S, 2, 2), int64 (N,).

    Segments and points are entered in lines of cells that are turned, and seen along them both ways; what is farther
    away from a point than ``farthest`` (N,) metres is not seen.
    """
    seen = np.zeros(len(points), np.int64)
    if not len(segments) or not len(points):
        return seen
    walls, _ = _along(segments, cell)
    middle, reach = points.mean(axis=0), (farthest / cell).astype(np.int64)
    for angle in np.arange(directions // 2) * 2 * np.pi / directions:
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        wall, place = (np.floor((ends - middle) @ turn / cell).astype(np.int64) for ends in (walls, points))
        span = np.ptp(np.concatenate([wall[:, 0], place[:, 0]])) + reach.max() + 2
        hits = np.unique(wall[:, 1] * span + wall[:, 0])
        home = place[:, 1] * span + place[:, 0]
        after = np.searchsorted(hits, home)
        before = after - 1 + (hits[after.clip(max=len(hits) - 1)] == home)
        seen += (before >= 0) & (home - hits[before] <= reach)
        seen += (after < len(hits)) & (hits[after.clip(max=len(hits) - 1)] - home <= reach)
    return seen
