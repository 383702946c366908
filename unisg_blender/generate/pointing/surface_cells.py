"""Cells on what can hold an object: level surfaces and walls, as points with the corners that are drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...geometry.polygon import inside
from ...spatial.level_surfaces import LEVEL
from ..place.settle_geometry import FRONT, Support

MOST, FINEST, WALL_STEP = 2500, 0.025, 0.12
"""Cells of a surface at most, about; metres along the side of a cell at least, and along a wall."""

TINY = 1e-9
"""Square metres of a place that is no cell."""

CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


@dataclass(frozen=True, eq=False)
class SurfaceCells:
    """N cells: middles (N, 3), corners (N, 4, 3) and areas (N,), metres; ``normal`` (N, 3) points off the surface."""

    points: Floats
    corners: Floats
    area: Floats
    normal: Floats

    def take(self, kept: Bools) -> SurfaceCells:
        """Some of them."""
        return SurfaceCells(self.points[kept], self.corners[kept], self.area[kept], self.normal[kept])


def joined_cells(parts: list[SurfaceCells]) -> SurfaceCells:
    """The cells of several surfaces, none of none."""
    none = SurfaceCells(np.zeros((0, 3)), np.zeros((0, 4, 3)), np.zeros(0), np.zeros((0, 3)))
    columns = zip(*(vars(part).values() for part in (none, *parts)), strict=True)
    return SurfaceCells(*(np.concatenate(column) for column in columns))


def level_cells(support: Support, height: float, outline: Floats | None) -> SurfaceCells:
    """Cells of what is level of a support at a height, metres; those of a floor within the room's outline only."""
    tops, found = support.tops, []
    level = np.flatnonzero(np.abs(tops.top - height) <= LEVEL)
    sizes = 4 * tops.half[level].prod(axis=1)
    step = max(FINEST, float(np.sqrt(sizes.max(initial=0.0) / MOST)))
    covered = np.zeros((0, 2))
    for number in level[np.argsort(-sizes, kind="stable")]:
        along = np.append(tops.along[number], 0.0)
        across = np.array([-along[1], along[0], 0.0])
        middle = np.append(tops.center[number], tops.top[number])
        cells = _rectangle(middle, along, across, tops.half[number], (step, step))
        if len(covered):  # a joined surface, and its pieces
            apart = np.abs(cells.points[:, None, :2] - covered).max(axis=2).min(axis=1)
            cells = cells.take(apart > step / 2)
        covered = np.concatenate([covered, cells.points[:, :2]])
        found.append(cells)
    cells = joined_cells(found)
    if support.floor and outline is not None:
        cells = cells.take(inside(outline, cells.points[:, :2]))
    return cells


def wall_cells(support: Support, outline: Floats | None) -> SurfaceCells:
    """Cells of the upright sides of a support that look into the room; of the largest part's both sides without one."""
    parts, found = support.parts, []
    for axes, half, center in zip(parts.axes, parts.half, parts.center, strict=True):
        thin = int(half[:2].argmin())
        across, along = axes[:, thin], axes[:, 1 - thin]
        for side in (1.0, -1.0):
            face = center + side * half[thin] * across
            if outline is not None and not inside(outline, (face + side * FRONT * across)[None, :2])[0]:
                continue
            size = np.array([half[1 - thin], half[2]])
            found.append(
                _rectangle(face, along, np.array([0.0, 0.0, 1.0]), size, (WALL_STEP, WALL_STEP), side * across)
            )
    return joined_cells(found)


def single_points(places: Floats, half: float = 0.0) -> SurfaceCells:
    """Level squares of half a side at places (N, 4); of next to no area, which show nothing, where that is 0."""
    corners = np.column_stack([CORNERS, np.zeros(4)]) * half
    area = np.full(len(places), max(4 * half**2, TINY))
    up = np.tile([0.0, 0.0, 1.0], (len(places), 1))
    return SurfaceCells(places[:, :3], places[:, None, :3] + corners, area, up)


def _rectangle(
    middle: Floats, along: Floats, across: Floats, half: Floats, step: tuple[float, float],
    normal: Floats | None = None,
) -> SurfaceCells:  # fmt: skip
    """Cells of about a size that fill a rectangle, looking up if no ``normal`` is given."""
    count = [max(round(2 * reach / size), 1) for reach, size in zip(half.tolist(), step, strict=True)]
    own = half / count
    u, v = (side.ravel() for side in np.meshgrid(*((2 * np.arange(many) + 1 - many) for many in count)))
    points = middle + u[:, None] * own[0] * along + v[:, None] * own[1] * across
    corners = points[:, None] + (CORNERS[:, :1] * own[0] * along + CORNERS[:, 1:] * own[1] * across)
    looks = np.array([0.0, 0.0, 1.0]) if normal is None else normal
    return SurfaceCells(points, corners, np.full(len(points), 4 * own.prod()), np.tile(looks, (len(points), 1)))
