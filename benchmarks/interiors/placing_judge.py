"""A judge of what was placed that shares no code with the generator's own check: rays and trees of Blender's mathutils,
outlines marked by eye, and whether a person still gets everywhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import bpy  # noqa: F401  it brings mathutils
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from scipy.ndimage import distance_transform_edt, label
from scipy.signal import fftconvolve
from scipy.spatial import ConvexHull, QhullError

from unisg_blender.scene import SceneGraph

SKIN, MOUNT_SKIN, LEAST = 0.006, 0.035, 0.4
"""Metres that a thing is made smaller on every side before it may meet nothing: one that stands, and one that is fixed
to something; and the share of its size that is left of a thin one."""

BUILT = 2.5
"""Metres of height and length from which on what is around a thing is a building, and no thing that it is in."""

GAP, ASIDE = 0.025, 0.035
"""Metres below a thing in which something must carry it; and around what hangs or is fixed."""

TIPS = 0.03
"""Metres that the middle of a thing may be beside what carries it."""

CELL, PERSON, LOW, HIGH, POCKET = 0.05, 0.25, 0.15, 1.8, 1.5
"""Metres: cells of the plan, half the width of a person, heights between which a person is; and the square metres of a
place that a thing may not cut off."""

BELOW, STOREY, MARKED = 0.3, 5.0, 0.1
"""Metres below a marked floor, and above it, in which a thing belongs to it; and within which outlines are marked."""


@dataclass(frozen=True, eq=False)
class Soup:
    """Triangles (M, 3, 3) in world metres, and the row (M,) of each."""

    triangles: Any
    row: Any

    @staticmethod
    def of(graph: SceneGraph, rows: Sequence[int]) -> Soup:
        """The meshes of some rows."""
        parts, numbers = [np.zeros((0, 3, 3))], [np.zeros(0, int)]
        for row in rows:
            if graph.mesh[row] >= 0:
                mesh, matrix = graph.meshes[graph.mesh[row]], np.asarray(graph.world[row])
                points = np.asarray(mesh.points, float) @ matrix[:3, :3].T + matrix[:3, 3]
                parts.append(points[np.asarray(mesh.triangles)])
                numbers.append(np.full(len(parts[-1]), row))
        triangles, row = np.concatenate(parts), np.concatenate(numbers)
        sound = np.isfinite(triangles).all(axis=(1, 2))
        return Soup(triangles[sound], row[sound])

    def near(self, low: Any, high: Any) -> Soup:
        """Those whose boxes meet a box."""
        hit = (self.triangles.min(axis=1) <= high).all(axis=1) & (self.triangles.max(axis=1) >= low).all(axis=1)
        return Soup(self.triangles[hit], self.row[hit])

    @cached_property
    def tree(self) -> BVHTree:
        """For rays and overlaps."""
        return tree_of(self.triangles)


def tree_of(triangles: Any) -> BVHTree:
    """A tree of triangles (M, 3, 3)."""
    corners = triangles.reshape(-1, 3)
    return BVHTree.FromPolygons(corners.tolist(), np.arange(len(corners)).reshape(-1, 3).tolist(), epsilon=0.0)


@dataclass(frozen=True, eq=False)
class Judge:
    """The interior before anything was placed, and the storeys that were marked by eye: floor, outline, unclear."""

    before: SceneGraph
    storeys: Sequence[dict[str, Any]]
    plans: dict[float, Plan] = field(default_factory=dict)

    @cached_property
    def room(self) -> Soup:
        """All that was there."""
        return Soup.of(self.before, range(len(self.before)))

    def verdicts(self, graph: SceneGraph, things: dict[int, bool]) -> dict[int, list[str]]:
        """What is wrong with new things: by row whether it is fixed to something or hangs -> words for its faults."""
        soups = {row: Soup.of(graph, _subtree(graph, row)) for row in things}
        found = {}
        for row, mounted in things.items():
            others = Soup(
                np.concatenate([self.room.triangles, *(soup.triangles for key, soup in soups.items() if key != row)]),
                np.concatenate([self.room.row, *(soup.row + 10**6 for key, soup in soups.items() if key != row)]),
            )
            found[row] = self._faults(soups[row].triangles, others, mounted)
        for row in self._cutting(soups):
            found[row].append("cuts off")
        return found

    def _faults(self, mine: Any, others: Soup, mounted: bool) -> list[str]:
        if not len(mine):
            return []
        low, high = mine.min(axis=(0, 1)), mine.max(axis=(0, 1))
        around = others.near(low - 0.1, high + 0.1)
        found = []
        if not self.indoors((low + high) / 2, low[2]):
            found.append("outside")
        if mounted:
            if not _touches(mine, around):
                found.append("in the air")
        elif not len(carried := _carried(mine, around)):
            found.append("in the air")
        elif not _stable(carried, mine.reshape(-1, 3).mean(axis=0)[:2], (low + high)[:2] / 2):
            found.append("tips")
        if _meets(shrunk(mine, MOUNT_SKIN if mounted else SKIN), around, others):
            found.append("in something")
        return found

    def plan(self, storey: dict[str, Any]) -> Plan:
        """The plan of a storey, made once."""
        if storey["floor"] not in self.plans:
            self.plans[storey["floor"]] = Plan.of(self.room, storey)
        return self.plans[storey["floor"]]

    def indoors(self, middle: Any, bottom: float) -> bool:
        """Within a marked outline; where no storey was marked at that height, under a roof or within walls."""
        here = [item for item in self.storeys if item["floor"] - BELOW <= bottom <= item["floor"] + STOREY]
        if here:
            shapes = [shape for item in here for shape in (*item["outline"], *item["unclear"])]
            around = middle[:2] + MARKED * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
            return any(_within(np.array(shape), point) for shape in shapes for point in around)
        eye = Vector((*middle[:2].tolist(), bottom + 1.4))
        turns = np.arange(16) * np.pi / 8
        hits = sum(self.room.tree.ray_cast(eye, Vector((np.cos(a), np.sin(a), 0)))[0] is not None for a in turns)
        return hits >= 15 or (hits >= 13 and self.room.tree.ray_cast(eye, Vector((0, 0, 1)))[0] is not None)

    def _cutting(self, soups: dict[int, Soup]) -> list[int]:
        """Which of some things cut a place off, from where a person could go before."""
        found = []
        for storey in self.storeys:
            level = storey["floor"]
            here = {row: soup for row, soup in soups.items()
                    if len(soup.triangles) and abs(soup.triangles[:, :, 2].min() - level) < STOREY / 2}  # fmt: skip
            if not here:
                continue
            plan = self.plan(storey)
            if plan.cut_by(list(here.values())):
                alone = [row for row, soup in here.items() if plan.cut_by([soup])]
                found += alone or list(here)[-1:]
        return found


@dataclass(frozen=True, eq=False)
class Plan:
    """Cells of a storey: ``inside`` is marked as such, ``taken`` what is in the way of a person, ``low`` the corner."""

    inside: Any
    taken: Any
    low: Any
    floor: float

    @staticmethod
    def of(soup: Soup, storey: dict[str, Any]) -> Plan:
        """The plan of a marked storey."""
        polygons = [np.array(shape) for shape in storey["outline"]]
        corners = np.concatenate(polygons)
        low = corners.min(axis=0) - 2 * CELL
        shape = tuple(((corners.max(axis=0) - low) / CELL).astype(int) + 3)
        x, y = (low[k] + (np.arange(shape[k]) + 0.5) * CELL for k in (0, 1))
        inside = np.zeros(shape, bool)
        for polygon in polygons:
            inside |= _polygon_cells(polygon, x, y)
        empty = Plan(inside, np.zeros(shape, bool), low, storey["floor"])
        return Plan(inside, empty.cells(soup), low, storey["floor"])

    def cells(self, soup: Soup, bottom: float = LOW, top: float = HIGH) -> Any:
        """Which cells triangles are in, between two heights over the floor."""
        high = self.low + np.array(self.inside.shape) * CELL
        near = soup.near(np.array([*self.low, self.floor + bottom]), np.array([*high, self.floor + top]))
        found = np.zeros(self.inside.shape, bool)
        for points in _sampled(near.triangles, CELL / 2):
            level = (points[:, 2] >= self.floor + bottom) & (points[:, 2] <= self.floor + top)
            cell = ((points[level, :2] - self.low) / CELL).astype(int)
            good = ((cell >= 0) & (cell < self.inside.shape)).all(axis=1)
            found[tuple(cell[good].T)] = True
        return found

    def walkable(self, taken: Any) -> Any:
        """Where a person can stand."""
        return distance_transform_edt(self.inside & ~taken) * CELL > PERSON

    def cut_by(self, soups: Sequence[Soup]) -> bool:
        """Is a place cut off by more things than were there?"""
        free = self.walkable(self.taken)
        more = self.taken.copy()
        for soup in soups:
            more |= self.cells(soup)
        before, count = label(free)
        after, _ = label(self.walkable(more))
        for number in range(1, count + 1):
            sizes = np.bincount(after[before == number])[1:] * CELL**2
            if (sizes >= POCKET).sum() > 1:
                return True
        return False

    def room_for(self, half: Any, height: float, taken: Any) -> bool:
        """Is there a rectangle of half sizes (2,) free somewhere, in any of eight directions?"""
        free = self.inside & ~taken
        if (distance_transform_edt(free) * CELL > np.hypot(*half) + CELL).any():
            return True
        for angle in np.arange(8) * np.pi / 8:
            way = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            reach = int(np.ceil(np.hypot(*half) / CELL)) + 1
            grid = np.stack(np.mgrid[-reach : reach + 1, -reach : reach + 1], axis=-1) * CELL
            kernel = (np.abs(grid @ way) <= half).all(axis=-1)
            if (fftconvolve(~free, kernel, mode="valid") < 0.5).any():
                return True
        return False


def shrunk(triangles: Any, by: float) -> Any:
    """Triangles of a thing made smaller by metres on every side, along the axes of the least box seen from above."""
    flat = triangles.reshape(-1, 3)[:, :2]
    angles = np.arange(90) * np.pi / 180
    turned = flat @ np.stack([np.cos(angles), np.sin(angles)]), flat @ np.stack([-np.sin(angles), np.cos(angles)])
    best = float(angles[(np.ptp(turned[0], axis=0) * np.ptp(turned[1], axis=0)).argmin()])
    turn = np.array([[np.cos(best), -np.sin(best), 0], [np.sin(best), np.cos(best), 0], [0, 0, 1]])
    own = triangles @ turn
    low, high = own.min(axis=(0, 1)), own.max(axis=(0, 1))
    share = np.maximum(1 - 2 * by / np.maximum(high - low, 1e-9), LEAST)
    middle = (low + high) / 2
    return ((own - middle) * share + middle) @ turn.T


def _meets(skin: Any, around: Soup, others: Soup) -> bool:
    """Does it go through faces, or lie within something closed?"""
    if len(around.triangles) and tree_of(skin).overlap(around.tree):
        return True
    point = Vector(skin.reshape(-1, 3)[0].tolist())
    low, high = skin.min(axis=(0, 1)), skin.max(axis=(0, 1))
    for row in np.unique(around.row):
        own = others.triangles[others.row == row]
        first, last = own.min(axis=(0, 1)), own.max(axis=(0, 1))
        house = last[2] - first[2] > BUILT and (last - first)[:2].max() > BUILT  # a room of one sheet is closed, too
        if not house and (first < low).all() and (last > high).all() and _odd(tree_of(own), point):
            return True
    return False


def _odd(tree: BVHTree, point: Vector) -> bool:
    """Is the number of faces odd in all of five directions?"""
    for way in ((1, 0.013, 0.017), (-1, 0.019, 0.011), (0.015, 1, 0.021), (0.012, -1, 0.018), (0.016, 0.014, 1)):
        count, start, step = 0, point.copy(), Vector(way).normalized()
        while count < 200:
            hit = tree.ray_cast(start, step)[0]
            if hit is None:
                break
            count, start = count + 1, hit + step * 1e-5
        if count % 2 == 0:
            return False
    return True


def _carried(mine: Any, around: Soup) -> Any:
    """Places (K, 2) at which something is close below a thing."""
    if not len(around.triangles):
        return np.zeros((0, 2))
    points = np.concatenate([mine.reshape(-1, 3), *_sampled(mine, 0.05)])
    points = np.unique(points.round(4), axis=0)
    bottom = points[points[:, 2] < points[:, 2].min() + 0.3 * max(np.ptp(points[:, 2]), 0.1)]
    down, found = Vector((0, 0, -1)), []
    for point in bottom:
        hit = around.tree.ray_cast(Vector((point[0], point[1], point[2] + 0.01)), down, GAP + 0.01)[0]
        if hit is not None:
            found.append(point[:2])
    mine_tree, up = tree_of(mine), Vector((0, 0, 1))
    for point in np.unique(around.triangles.reshape(-1, 3).round(4), axis=0):
        if mine_tree.ray_cast(Vector((point[0], point[1], point[2] - 0.01)), up, GAP + 0.01)[0] is not None:
            found.append(point[:2])
    return np.array(found).reshape(-1, 2)


def _stable(carried: Any, mass: Any, middle: Any) -> bool:
    """Is the middle of a thing, of its corners or of its box, over what carries it?"""
    try:
        hull = ConvexHull(carried)
    except QhullError:
        return bool(min(np.linalg.norm(carried - at, axis=1).min() for at in (mass, middle)) <= TIPS)
    way, offset = hull.equations[:, :2], hull.equations[:, 2]
    return any((way @ at + offset).max() <= TIPS for at in (mass, middle))


def _touches(mine: Any, around: Soup) -> bool:
    if not len(around.triangles):
        return False
    points = np.concatenate([mine.reshape(-1, 3), *_sampled(mine, 0.05)])
    return any(around.tree.find_nearest(Vector(point.tolist()), ASIDE)[0] is not None for point in points)


def _sampled(triangles: Any, step: float) -> list[Any]:
    """Points on triangles, not farther than a step apart, in handfuls."""
    if not len(triangles):
        return []
    longest = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
    parts = np.ceil(longest / step).astype(int).clip(1)
    found = []
    for count in np.unique(parts):
        own = triangles[parts == count]
        i, j = (side.ravel() for side in np.mgrid[0 : count + 1, 0 : count + 1])
        keep = i + j <= count
        share = np.stack([i[keep], j[keep], count - i[keep] - j[keep]], axis=1) / count
        for start in range(0, len(own), max(1, 2_000_000 // len(share))):
            some = own[start : start + max(1, 2_000_000 // len(share))]
            found.append(np.einsum("sk,mkd->msd", share, some).reshape(-1, 3))
    return found


def _polygon_cells(polygon: Any, x: Any, y: Any) -> Any:
    found = np.zeros((len(x), len(y)), bool)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if a[1] != b[1]:
            over = (y >= min(a[1], b[1])) & (y < max(a[1], b[1]))
            found[:, over] ^= x[:, None] < (a[0] + (y[over] - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))[None]
    return found


def _within(polygon: Any, point: Any) -> bool:
    return bool(_polygon_cells(polygon, point[:1], point[1:2])[0, 0])


def _subtree(graph: SceneGraph, row: int) -> list[int]:
    found = {row}
    for below in range(row + 1, len(graph)):
        if int(graph.parent[below]) in found:
            found.add(below)
    return sorted(found)
