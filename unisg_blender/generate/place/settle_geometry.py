"""Settling: proposed places become places where an object rests on its support, is in the room and touches nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.boxes import Boxes, part_bottoms, part_tops, world_bounds
from ...geometry.planar import footprints, rotate, turned_reach
from ...geometry.polygon import inside, outside_distance, to_edges
from ...spatial.level_surfaces import LEVEL, LevelSurfaces, rectangles, with_joined
from ..observe.placeable import Placeable
from ..observe.support_priors import AT_SIDE, HANGS, RESTS, SupportPrior
from .free_space import FreeSpace
from .inner_levels import onto_level
from .ways_kept import WaysKept

OUTSIDE = 0.001
"""Metres by which a footprint may leave the room."""

LOOSE = 0.01
"""Metres of clearance up to which an object that hangs counts as held."""

NEAR_ROOM = 0.5
"""A support that is farther out of the room than this, in metres, may hold objects out there."""

SEARCH, CHUNK, AROUND = 9, 81, 1.5
"""Places along each side of a surface that the last search tries, with three turns each, so many at a time; on bare
ground so many metres around."""

LEVEL_FOR_AREA = 0.1
"""Metres of height that a square metre of surface (a quarter of it) is worth when a surface is searched."""

CARRIES, TOO_SMALL, BESIDE = 0.2, 0.05, 2.0
"""A surface of less than this share of the footprint carries nothing well, and counts as so many metres farther away;
a metre beside a surface counts as so many metres of height."""

WALL, FRONT = 0.3, 0.05
"""Half thickness of a wall at most, and how far in front of it one looks for the room, metres."""

PULLS, MARGIN = 4, 1e-4
"""Times that a footprint is pulled into the room, a corner at a time, and by how many metres more than need be."""


@dataclass(frozen=True, eq=False)
class Support:
    """What an object is to be held by: ``obj`` is its number (-1: the ground at height 0), ``prior`` how.

    ``floor`` says that it is the floor of the room, ``structural`` that what it is to
    hold is part of the building and may reach out of the room; ``levels`` are heights of what is level within it, for
    what is to lie inside.
    """

    obj: int
    prior: SupportPrior
    parts: Boxes
    floor: bool
    structural: bool = False
    levels: Floats = field(default_factory=lambda: np.zeros(0))

    @cached_property
    def tops(self) -> LevelSurfaces:
        """The upper sides of its parts."""
        return with_joined(rectangles(self.parts))

    @property
    def contact(self) -> str:
        """How the object is held."""
        return self.prior.contact

    @property
    def is_slope(self) -> bool:
        """Is there nothing level to rest on?"""
        return self.contact == RESTS and len(self.parts.center) > 0 and not len(self.tops.top)

    def indoors(self, space: FreeSpace) -> bool:
        """Is the support in the room or at its walls, so that what it holds should be in the room?"""
        if space.outline is None or self.structural:
            return False
        if self.floor or not len(self.parts.center):
            return True
        return bool(outside_distance(space.outline, self.parts.center[:, :2]).min() < NEAR_ROOM)


def rest(placeable: Placeable, places: Floats, support: Support, space: FreeSpace) -> Floats:
    """The places (T, 4), each moved as little as need be so that the placeable is held the way its prior says."""
    places = places.copy()
    if support.contact == RESTS:
        if support.obj < 0:
            places[:, 2] = 0.0
        elif len(support.tops.top):
            places = _onto_surface(placeable, places, support.tops, clamp=not support.floor)
        if len(support.levels):
            places[:, 2] = onto_level(places[:, 2], support.levels)
        if support.floor:
            places = into_room(placeable, places, space)
    elif support.contact == HANGS and len(support.parts.center):
        places = _hung(placeable, places, support.parts)
    elif support.contact == AT_SIDE and len(support.parts.center):
        places = _to_side(placeable, places, support, space)
    if support.contact != RESTS and len(support.parts.center) and len(placeable.parts.center):
        places = _touching(placeable, places, support.parts)
    return places


def _hung(placeable: Placeable, places: Floats, parts: Boxes) -> Floats:
    """The places below the lowest of some parts, moved until what a thing hangs by is under one of them.

    It hangs by the middle of its highest parts.
    """
    bottoms, result = part_bottoms(parts), places.copy()
    result[:, 2] = bottoms.min() - 2 * placeable.half[2]
    if not len(placeable.parts.center):
        return result
    tops = part_tops(placeable.parts)
    low, high = world_bounds(placeable.parts.take(np.flatnonzero(tops >= tops.max() - LOOSE)))
    mount = (low.min(axis=0) + high.max(axis=0))[:2] / 2
    at = result[:, :2] + rotate(np.tile(mount, (len(result), 1)), result[:, 3])
    over = parts.take(np.flatnonzero(bottoms <= bottoms.min() + LOOSE))
    steps = []
    for center, axes, half in zip(over.center[:, :2], over.axes[:, :2, :2], over.half[:, :2], strict=True):
        steps.append(center + np.clip((at - center) @ axes, -half, half) @ axes.T - at)
    nearest = np.linalg.norm(steps, axis=2).argmin(axis=0)
    result[:, :2] += np.array(steps)[nearest, np.arange(len(result))]
    return result


def nearest_support(placeable: Placeable, places: Floats, supports: Sequence[Support], space: FreeSpace) -> Ints:
    """Which of the supports reaches each place (T, 4) by the shortest move, int64 (T,)."""
    moves = [np.linalg.norm((rest(placeable, places, support, space) - places)[:, :3], axis=1) for support in supports]
    return np.argmin(moves, axis=0)


def _touching(placeable: Placeable, places: Floats, parts: Boxes) -> Floats:
    """The places moved the shortest way until some part of the placeable touches some of the support's parts."""
    boxes = placeable.boxes_at(places)
    count = len(placeable.parts.center)
    axes = parts.axes
    offset = np.einsum("sij,psi->psj", axes, boxes.center[:, None] - parts.center)
    reach = np.einsum("psij,pj->psi", np.abs(np.einsum("ski,pkj->psij", axes, boxes.axes)), boxes.half)
    gap = np.maximum(np.abs(offset) - parts.half - reach, 0)
    distance = np.linalg.norm(gap, axis=2).reshape(len(places), -1)
    nearest = distance.argmin(axis=1)
    part, other = nearest // len(parts.center), nearest % len(parts.center)
    row = np.arange(len(places)) * count + part
    step = np.einsum("tij,tj->ti", axes[other], -np.sign(offset[row, other]) * gap[row, other])
    result = places.copy()
    result[:, :3] += step * (distance[np.arange(len(places)), nearest] > LOOSE)[:, None]
    return result


def _onto_surface(placeable: Placeable, places: Floats, tops: LevelSurfaces, clamp: bool) -> Floats:
    """Each place on the surface nearest to it, its footprint on it as far as it is large enough."""
    across = np.stack([-tops.along[:, 1], tops.along[:, 0]], axis=1)
    offset = places[:, None, :2] - tops.center
    local = np.stack([(offset * tops.along).sum(-1), (offset * across).sum(-1)], axis=2)  # (T, S, 2)
    beyond = np.maximum(np.abs(local) - tops.half, 0).sum(axis=2)
    small = TOO_SMALL * (tops.half.prod(axis=1) < CARRIES * placeable.half[:2].prod())
    nearest = (np.abs(tops.top - places[:, 2, None]) + BESIDE * beyond + small).argmin(axis=1)
    result = places.copy()
    result[:, 2] = tops.top[nearest]
    if len(tops.top) > 1:
        result[:, 2] = _highest_under(placeable, places, local, tops, nearest)
    if not clamp:
        return result
    turn = places[:, 3] - np.arctan2(tops.along[nearest, 1], tops.along[nearest, 0])
    reach = turned_reach(placeable.half, turn)
    room = np.maximum(tops.half[nearest] - reach, 0)
    mine = np.clip(local[np.arange(len(places)), nearest], -room, room)
    result[:, :2] = tops.center[nearest] + mine[:, :1] * tops.along[nearest] + mine[:, 1:] * across[nearest]
    return result


def _highest_under(placeable: Placeable, places: Floats, local: Floats, tops: LevelSurfaces, nearest: Ints) -> Floats:
    """Height (T,) of the highest surface of the nearest one's level under each footprint: a rug is thicker inside.

    ``local`` (T, S, 2) are the places as the surfaces see them.
    """
    turn = places[:, 3, None] - np.arctan2(tops.along[:, 1], tops.along[:, 0])
    reach = turned_reach(placeable.half, turn)
    under = (np.abs(local) < tops.half + reach).all(axis=2)
    own = tops.top[nearest, None]
    level = under & (tops.top >= own) & (tops.top <= own + LEVEL)
    return np.where(level, tops.top, own).max(axis=1)


def into_room(placeable: Placeable, places: Floats, space: FreeSpace) -> Floats:
    """The places pulled into the room's outline where their footprints leave it."""
    if space.outline is None:
        return places
    result = places.copy()
    for _ in range(PULLS):
        corners = footprints(placeable.half, result)
        wrong = ~inside(space.outline, corners)
        if not wrong.any():
            break
        pull = to_edges(space.outline, corners)
        length = np.linalg.norm(pull, axis=-1)
        nearest = length.argmin(axis=2)[..., None]
        step = np.take_along_axis(pull, nearest[..., None], axis=2)[:, :, 0]
        far = np.take_along_axis(length, nearest, axis=2)[..., 0] * wrong
        worst = far.argmax(axis=1)
        rows = np.arange(len(result))
        length_of = np.maximum(far[rows, worst], 1e-12)[:, None]
        result[:, :2] += step[rows, worst] * (1 + MARGIN / length_of) * (far[rows, worst] > 0)[:, None]
    return result


def _to_side(placeable: Placeable, places: Floats, support: Support, space: FreeSpace) -> Floats:
    """The places moved along the normal of the support's nearest side until the usual gap is left."""
    parts = support.parts
    largest = int(parts.half.prod(axis=1).argmax())
    axes, half, middle = parts.axes[largest, :2, :2], parts.half[largest, :2], parts.center[largest, :2]
    turn = places[:, 3] - np.arctan2(axes[1, 0], axes[0, 0])
    reach = turned_reach(placeable.half, turn)
    local = (places[:, :2] - middle) @ axes
    thin = int(half.argmin())
    sides = np.sign(local[:, thin]) + (local[:, thin] == 0)
    if space.outline is not None and half[thin] < WALL:  # the side that looks into the room
        inner = middle + np.outer([1, -1], axes[:, thin]) * (half[thin] + FRONT)
        into = inside(space.outline, inner)
        if into[0] != into[1]:
            sides[:] = 1.0 if into[0] else -1.0
    local[:, thin] = sides * (half[thin] + reach[:, thin] + max(support.prior.gap, 0.0))
    long = 1 - thin
    low, high = _extent(parts, middle, axes[:, long])
    between, room = (low + high) / 2, np.maximum((high - low) / 2 - reach[:, long], 0)
    local[:, long] = between + np.clip(local[:, long] - between, -room, room)
    result = places.copy()
    result[:, :2] = middle + local @ axes.T
    bottom, top, high = part_bottoms(parts).min(), part_tops(parts).max(), 2 * placeable.half[2]
    result[:, 2] = np.where(result[:, 2] > top - LOOSE, top - high, result[:, 2])  # at an edge nothing holds it
    result[:, 2] = np.where(result[:, 2] + high < bottom + LOOSE, bottom, result[:, 2])
    return result


def _extent(parts: Boxes, origin: Floats, along: Floats) -> tuple[float, float]:
    """From where to where all parts together reach along a horizontal direction (2,), metres from an origin (2,)."""
    at = (parts.center[:, :2] - origin) @ along
    reach = (np.abs(np.einsum("pij,i->pj", parts.axes[:, :2], along)) * parts.half).sum(axis=1)
    return float((at - reach).min()), float((at + reach).max())


def fitting(placeable: Placeable, places: Floats, category: int, support: Support, space: FreeSpace) -> Bools:
    """At which places (T,) the placeable meets nothing, and is in the room, if its support is; nowhere on a slope."""
    if support.is_slope:
        return np.zeros(len(places), bool)
    good = space.depth(placeable, places, category, support.obj) <= 0
    if good.any() and support.indoors(space):
        good[good] = space.outside(placeable, places[good]) <= OUTSIDE
    return good


def search(
    placeable: Placeable, near: Floats, category: int, support: Support, space: FreeSpace, ways: WaysKept | None = None
) -> Floats | None:
    """The free place nearest to ``near`` (4,) among a grid over the support's surface, one that does not cut the floor
    if ``ways`` tell; None if there is none."""
    if support.contact != RESTS or support.is_slope:
        return None
    straight = near[3] + np.pi / 4
    if support.obj < 0 or not len(support.parts.center):
        spread = np.linspace(-AROUND, AROUND, SEARCH)
        grid = near[:2] + np.stack(np.meshgrid(spread, spread), axis=-1).reshape(-1, 2)
    else:
        tops = support.tops
        best = int((np.abs(tops.top - near[2]) - LEVEL_FOR_AREA * tops.half.prod(axis=1)).argmin())
        across = np.array([-tops.along[best, 1], tops.along[best, 0]])
        straight = np.arctan2(tops.along[best, 1], tops.along[best, 0])
        spread = np.linspace(-1, 1, SEARCH)
        u, v = (side.reshape(-1, 1) for side in np.meshgrid(spread, spread))
        grid = tops.center[best] + u * tops.half[best, 0] * tops.along[best] + v * tops.half[best, 1] * across
    order = np.argsort(((grid - near[:2]) ** 2).sum(axis=1))
    turns = (near[3], straight, straight + np.pi / 2)
    places = np.stack([np.array([x, y, near[2], yaw]) for x, y in grid[order] for yaw in turns])
    for start in range(0, len(places), CHUNK):
        some = rest(placeable, places[start : start + CHUNK], support, space)
        good = fitting(placeable, some, category, support, space)
        best = ways.best(placeable, some, good) if ways is not None else int(good.argmax()) if good.any() else -1
        if best >= 0:
            return some[best]
    return None
