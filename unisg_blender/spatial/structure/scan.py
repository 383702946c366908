"""A scene as it is scanned for its structure: all triangles, and where the columns of a grid meet them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.column_raster import Crossings, Grid, columns, slice_at
from ...geometry.grouped_ends import grouped_ends
from ...geometry.surface_contact import STEEPEST, Triangles
from ...scene.categories import FLOOR, STRUCTURE, has_category
from ...scene.graph import SceneGraph
from ...scene.hierarchy import world_matrices
from ..object_rows import marked_things, object_rows, shown

FINEST, MOST_CELLS = 0.05, 150_000
"""Metres of a cell, at least; and cells at most: larger scenes are scanned more coarsely."""

MOST_CROSSINGS = 3_000_000
"""Places at most where columns meet triangles: what lies in many layers is scanned more coarsely."""

HEADROOM = 1.8
"""Metres that must be free over a floor where people stand."""

SAMPLE = 4000
"""Triangles at most that are asked whether they are in a room seen from outside."""

HOLLOW = 1.0
"""Square metres at least of what may be a room seen from outside."""

MOSTLY_WITHIN = 0.5
"""Share of a thing, by its triangles, that is within another's box, at least, for it to be in there."""

CLOSED, SOLID = 1e-4, 0.5
"""Share of its area by which a mesh may be open and still is closed; and metres of the mean thickness of a solid that
is no room, at most."""

LEAST = 1.0
"""Square metres of a room, at least."""

TINY = 0.02
"""Cells of area seen from above of a triangle whose edges may be a floor's, at least."""

LEVEL = 0.12
"""Metres of height within which surfaces are one floor: rugs, thresholds, a little slope."""

SAME = 0.002
"""Metres within which what a column meets counts as one surface."""


@dataclass(frozen=True, eq=False)
class Scan:
    """M triangles of a scene over a grid.

    Attributes
    ----------
    triangles, row
        (M, 3, 3) metres, and int64 (M,): the entity of each.
    building
        bool (M,): what may be building; what the user gave another category is not.
    is_floor
        bool (M,): what the user called a floor; all False where nothing is called so.
    """

    triangles: Triangles
    row: Ints
    building: Bools
    is_floor: Bools
    grid: Grid

    @staticmethod
    def of(graph: SceneGraph, region: tuple[Floats, Floats] | None = None, without: int = -1) -> Scan | None:
        """The scan of a scene, or of what reaches into a region (low, high) (2,); None where there are no triangles.

        The row ``without`` is left out.
        """
        triangles, row = world_triangles(graph)
        if without >= 0:
            triangles, row = triangles[row != without], row[row != without]
        if region is not None:
            low, high = region
            near = (triangles[:, :, :2].min(axis=1) <= high) & (triangles[:, :, :2].max(axis=1) >= low)
            triangles, row = triangles[near.all(axis=1)], row[near.all(axis=1)]
        if not len(triangles):
            return None
        corners = triangles.reshape(-1, 3)
        low, high = region or (corners.min(axis=0)[:2], corners.max(axis=0)[:2])
        cell = max(FINEST, float(np.sqrt(np.prod(np.maximum(high - low, FINEST)) / MOST_CELLS)))
        cell = max(cell, float(np.sqrt(_seen_from_above(triangles, low, high) / MOST_CROSSINGS)))
        owner = object_rows(graph)
        named = graph.category[owner] >= 0
        free = ~marked_things(graph)
        building = (~named | has_category(graph, STRUCTURE)[owner]) & free
        is_floor = has_category(graph, [FLOOR])[owner] & free
        return Scan(triangles, row, building[row], is_floor[row], Grid.around(low, high, cell))

    @cached_property
    def normals(self) -> Floats:
        """Normals (M, 3), as long as the triangles are large."""
        one, two = ((self.triangles[:, corner] - self.triangles[:, 0]).T for corner in (1, 2))
        ways = [one[axis - 2] * two[axis - 1] - one[axis - 1] * two[axis - 2] for axis in range(3)]
        return np.ascontiguousarray(np.stack(ways).T)

    @cached_property
    def slope(self) -> Floats:
        """The upward part of the unit normals, (M,): 1 level and looking up, -1 looking down, 0 upright."""
        length = np.sqrt(np.einsum("mi,mi->m", self.normals, self.normals))
        return self.normals[:, 2] / np.maximum(length, 1e-300)

    @cached_property
    def up(self) -> Bools:
        """Which triangles look up, bool (M,); those of rooms and of solids drawn inside out are turned round."""
        looks_up = self.slope > 0
        for row in (*_inside_out(self), *_turned_solids(self)):
            mine = self.row == row
            looks_up[mine] = ~looks_up[mine]
        return looks_up

    @cached_property
    def ends(self) -> tuple[Floats, Floats]:
        """Heights of the lowest and highest corner of each triangle, (M,) each."""
        first, second, third = self.triangles[:, :, 2].T
        return np.minimum(np.minimum(first, second), third), np.maximum(np.maximum(first, second), third)

    @cached_property
    def flat(self) -> Ints:
        """Numbers of the triangles that are about level, within what counts as one floor, and not tiny."""
        low, high = self.ends
        return np.flatnonzero((high - low <= 2 * LEVEL) & (np.abs(self.normals[:, 2]) > TINY * self.grid.cell**2))

    @cached_property
    def flat_boxes(self) -> tuple[Floats, Floats]:
        """The lowest and highest corners (3, F) of the boxes around those."""
        one, two, three = self.triangles[self.flat].transpose(1, 2, 0)
        return np.minimum(np.minimum(one, two), three), np.maximum(np.maximum(one, two), three)

    @cached_property
    def all_columns(self) -> Crossings:
        """Where columns meet any triangle, except what is nearly upright."""
        level = np.flatnonzero(np.abs(self.slope) > STEEPEST)
        found = columns(self.triangles[level], self.grid)
        return Crossings(found.cell, found.height, level[found.triangle])

    @cached_property
    def building_columns(self) -> Crossings:
        """The same, of what may be building, surfaces in one place once."""
        found = self.all_columns.take(self.building[self.all_columns.triangle])
        again = (np.diff(found.cell, prepend=-1) == 0) & (np.diff(found.height, prepend=-np.inf) < SAME)
        return found.take(~again)

    def cut(self, height: float, hanging: float = -1.0) -> tuple[Floats, Ints]:
        """Segments (S, 2, 2) where a level plane cuts what may be walls, no slopes of land, and the rows (S,).

        ``hanging`` is the upward part of the unit normal of what is cut, at least: -1 is a ceiling.
        """
        low, high = self.ends
        cut = np.flatnonzero(
            self.building & (low <= height) & (high > height) & (self.slope <= STEEPEST) & (self.slope >= hanging)
        )
        return slice_at(self.triangles[cut], height), self.row[cut]


def world_triangles(graph: SceneGraph) -> tuple[Triangles, Ints]:
    """The triangles (M, 3, 3) of a scene in the world, metres, and the row (M,) of each; what is no number left out."""
    world, seen = world_matrices(graph), np.flatnonzero(shown(graph))
    turned, moved = np.ascontiguousarray(world[:, :3, :3].transpose(0, 2, 1)), world[:, :3, 3]
    mirrored = np.linalg.det(turned) < 0
    meshes = [graph.meshes[number] for number in graph.mesh[seen].tolist()]
    count = [len(mesh.triangles) for mesh in meshes]
    triangles, first = np.empty((sum(count), 3, 3)), 0
    for row, mesh, many in zip(seen.tolist(), meshes, count, strict=True):
        corners = mesh.points.astype(np.float64) @ turned[row]
        corners += moved[row]
        np.take(corners, mesh.triangles, axis=0, out=triangles[first : first + many])
        first += many
    rows = np.repeat(seen, count).astype(np.int64)
    triangles[mirrored[rows]] = triangles[mirrored[rows]][:, ::-1]
    if np.isfinite(triangles.sum()):
        return triangles, rows
    sound = np.isfinite(triangles).all(axis=(1, 2))
    return triangles[sound], rows[sound]


def _seen_from_above(triangles: Triangles, low: Floats, high: Floats) -> float:
    """Square metres of triangles within a rectangle, layer by layer, about: of large ones what could be in it."""
    corner = triangles[:, :, :2]
    one, two = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) / 2
    return float(np.minimum(area, np.prod(high - low)).sum())


@dataclass(frozen=True, eq=False)
class FreeSpans:
    """Spans of air in columns, from the floor ``low`` to what is above, ``high`` (inf for the sky), (N,) each.

    ``cell`` and ``triangle`` say where and on what each begins, ``over`` the triangle above, -1 for none.
    """

    cell: Ints
    low: Floats
    high: Floats
    triangle: Ints
    over: Ints


def free_spans(found: Crossings, up: Bools) -> FreeSpans:
    """The spans of air over all that columns meet: not those that are within something solid."""
    last = np.diff(found.cell, append=-1) != 0
    above = np.append(found.height[1:], np.inf)
    high = np.where(last, np.inf, above)
    over = np.where(last, -1, np.append(found.triangle[1:], -1))
    solid = ~last & ~up[found.triangle] & up[over]
    kept = ~solid
    return FreeSpans(found.cell[kept], found.height[kept], high[kept], found.triangle[kept], over[kept])


def _inside_out(scan: Scan) -> list[int]:
    """Rows of closed meshes whose faces look out of rooms: more lies inside them than where their faces say is air."""
    found, (low, high) = [], scan.ends
    crossings = scan.all_columns
    owner = scan.row[crossings.triangle]
    tall = grouped_ends(owner, int(scan.row.max()) + 1, crossings.height)
    built = np.zeros(len(tall[0]), bool)
    built[scan.row[scan.building]] = True
    many = np.bincount(owner, minlength=len(built)) * scan.grid.cell**2 >= 2 * HOLLOW
    rows = np.flatnonzero(built & many & (tall[1] - tall[0] >= HEADROOM))
    looks_up = scan.slope > 0
    for row in rows.tolist():
        mine = crossings.take(owner == row)
        solid = _spans_of(mine, looks_up, solid=True)
        solid = solid[mine.height[solid + 1] - mine.height[solid] >= HEADROOM]
        if len(solid) * scan.grid.cell**2 < HOLLOW:
            continue
        sample = np.arange(0, len(low), max(len(low) // SAMPLE, 1))
        sample = sample[scan.row[sample] != row]
        within = (high[sample] < mine.height.max()) & (low[sample] > mine.height.min())
        sample = sample[within & _mostly_within(scan, row, sample)]
        middle = scan.triangles[sample].mean(axis=1)
        cell = scan.grid.at(middle[:, :2])
        inside, air = (
            _held(mine, some, cell[cell >= 0], middle[cell >= 0, 2])
            for some in (solid, _spans_of(mine, looks_up, solid=False))
        )
        if inside > air:
            found.append(row)
    return found


def _mostly_within(scan: Scan, row: int, sample: Ints) -> Bools:
    """Which of some triangles are of things most of which is within the box around another, bool (S,).

    What only reaches into a block says nothing of it: a figure leans on it.
    """
    around = scan.triangles[scan.row == row].reshape(-1, 3)
    corners = scan.triangles[sample]
    within = ((corners >= around.min(axis=0) - SAME) & (corners <= around.max(axis=0) + SAME)).all(axis=(1, 2))
    owner = scan.row[sample]
    count = int(scan.row.max()) + 1
    share = np.bincount(owner, within, minlength=count) / np.maximum(np.bincount(owner, minlength=count), 1)
    return share[owner] >= MOSTLY_WITHIN


def _turned_solids(scan: Scan) -> list[int]:
    """Rows of closed meshes, as thin as walls and slabs, whose faces look inwards: nobody stands in there."""
    count, row = int(scan.row.max()) + 1, scan.row
    start = np.zeros((count, 3))
    start[row[::-1]] = scan.triangles[::-1, 0]
    volume = np.bincount(row, np.einsum("mi,mi->m", scan.triangles[:, 0] - start[row], scan.normals)) / 6
    inwards = volume < 0
    if not inwards.any():
        return []
    open_by = np.stack([np.bincount(row, way) for way in scan.normals.T], axis=1) / 2
    area = np.bincount(row, np.linalg.norm(scan.normals, axis=1)) / 2
    closed = np.linalg.norm(open_by, axis=1) <= CLOSED * area
    return np.flatnonzero(inwards & closed & (-2 * volume <= SOLID * area)).tolist()


def _spans_of(mine: Crossings, looks_up: Bools, solid: bool) -> Ints:
    """Where in columns something solid begins and ends with the next place, or else air between floor and ceiling."""
    below, above = mine.triangle[:-1], mine.triangle[1:]
    same = mine.cell[1:] == mine.cell[:-1]
    return np.flatnonzero(same & (looks_up[below] != solid) & (looks_up[above] == solid))


def _held(mine: Crossings, spans: Ints, cell: Ints, height: Floats) -> int:
    """How many points, by cell and height, are in some spans of columns."""
    scale = 2.0 * (np.ptp(mine.height) + 1.0)
    base = float(mine.height.min()) - 0.5
    key = mine.cell * scale + (mine.height - base)
    below = np.searchsorted(key, cell * scale + (height - base)) - 1
    return int(np.isin(below, spans).sum())
