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
from scipy.spatial import ConvexHull, QhullError
from triangle_soup import Soup, sampled, tree_of
from walked_plan import Plan, within

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

BELOW, STOREY, MARKED = 0.3, 5.0, 0.1
"""Metres below a marked floor, and above it, in which a thing belongs to it; and within which outlines are marked."""


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
        skin = shrunk(mine, MOUNT_SKIN if mounted else SKIN)
        if _meets(skin, around) or _lies_within(skin, others):
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
            return any(within(np.array(shape), point) for shape in shapes for point in around)
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


def _meets(skin: Any, around: Soup) -> bool:
    """Does it go through faces?"""
    return bool(len(around.triangles) and tree_of(skin).overlap(around.tree))


def _lies_within(skin: Any, others: Soup) -> bool:
    """Does it lie within something closed, no matter how far its faces are?"""
    point = Vector(skin.reshape(-1, 3)[0].tolist())
    low, high = skin.min(axis=(0, 1)), skin.max(axis=(0, 1))
    for row in np.unique(others.row):
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
    points = np.concatenate([mine.reshape(-1, 3), *sampled(mine, 0.05)])
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
    points = np.concatenate([mine.reshape(-1, 3), *sampled(mine, 0.05)])
    return any(around.tree.find_nearest(Vector(point.tolist()), ASIDE)[0] is not None for point in points)


def _subtree(graph: SceneGraph, row: int) -> list[int]:
    found = {row}
    for below in range(row + 1, len(graph)):
        if int(graph.parent[below]) in found:
            found.add(below)
    return sorted(found)
