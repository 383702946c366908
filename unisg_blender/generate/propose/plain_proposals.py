"""Plain proposals: seen places tried in another scene: at the same part of a support, at walls, beside neighbours."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.planar import rotate
from ..observe.observed_scene import ObservedScene
from ..observe.prior_tables import PriorTables
from ..observe.room_walls import QUARTER, RoomWalls
from ..observe.seen_places import (
    ABOVE,
    ACROSS,
    ALONG,
    GAP,
    KIND,
    NEAR,
    NEIGHBOURS,
    ON_TOP,
    PER_NEIGHBOUR,
    TURN,
    WALL_TURN,
)  # fmt: skip
from .proposer import Proposals

FRACTION, AT_WALL, BESIDE, ANYWHERE = range(4)
SHARES = (0.3, 0.3, 0.25, 0.15)
"""How often a place is tried at the same fraction of a support, at a wall, beside a neighbour, anywhere."""

PLAINEST = (1.0, 0.0, 0.0, 0.0)
"""Only the simplest way, and also where there is no room: what learning is measured against."""

MOSTLY = 0.8
"""Share of the things on the floor that walls enclose if they are those of a room, and not of several or of none."""


@dataclass(frozen=True, eq=False)
class TriedRoom:
    """A scene in which places are tried: which objects are there, bool (K,), its walls, what is building."""

    scene: ObservedScene
    seen: Bools
    walls: RoomWalls
    structural: Bools

    @staticmethod
    def of(scene: ObservedScene, tables: PriorTables, seen: Bools | None = None) -> TriedRoom:
        """Of a scene, all of which is there unless ``seen`` says otherwise."""
        there = np.ones(len(scene.category), bool) if seen is None else seen
        return TriedRoom(scene, there, RoomWalls.of(scene, tables), tables.structural[scene.category])

    @cached_property
    def enclosed(self) -> bool:
        """Whether the walls enclose what stands on the floor."""
        things = ~self.structural & (self.scene.room.level <= 1)
        return bool(things.any()) and float(self.walls.inside(self.scene.center[things, :2]).mean()) >= MOSTLY


def plain_proposals(
    room: TriedRoom, places: Floats, half: Floats, allowed: Bools, count: int, rng: np.random.Generator,
    ways: tuple[float, ...] = SHARES,
) -> Proposals:  # fmt: skip
    """``count`` proposals for an object of half extents (3,) on the ``allowed`` objects.

    ``places`` (P, ...) are the seen places of its category; ``ways`` the shares of the four ways.
    """
    if not len(places):
        places = np.zeros((1, NEAR + NEIGHBOURS * PER_NEIGHBOUR))
        places[:, [KIND, NEAR]] = -2, -1
    drawn = places[rng.integers(len(places), size=count)]
    scene, support = room.scene, _supports(room, drawn, allowed, rng)
    result, held = np.zeros((count, 4)), support >= 0
    below = np.maximum(support, 0)
    base = np.where(held, scene.yaw[below], 0.0) if len(scene.yaw) else np.zeros(count)
    result[:, 3] = drawn[:, TURN] + base
    result[:, :2] = _at(scene, support, drawn[:, [ACROSS, ALONG]])
    on_floor = ~held | room.structural[below] if len(scene.yaw) else ~held
    way = rng.choice(4, size=count, p=ways)
    way[(way == AT_WALL) & ~on_floor] = ANYWHERE
    _anywhere(scene, support, result, way == ANYWHERE, base, rng)
    _at_walls(room.walls, result, drawn, half, way == AT_WALL, rng)
    _beside(room, result, support, drawn, way == BESIDE, on_floor, rng)
    if ways is not PLAINEST:
        again = _instead(room, result, on_floor, rng)
        support, result, drawn = support[again], result[again], drawn[again]
    result[:, 2] = _bottoms(scene, support, drawn)
    return Proposals(support, result)


def _instead(room: TriedRoom, places: Floats, on_floor: Bools, rng: np.random.Generator) -> Ints:
    """Which proposal stands for each (T,): itself, or, of one on the floor outside the walls, another one."""
    again = np.arange(len(places))
    if room.enclosed:
        outside = on_floor & ~room.walls.inside(places[:, :2])
        if outside.any() and not outside.all():
            again[outside] = rng.choice(np.flatnonzero(~outside), size=int(outside.sum()))
    return again


def _supports(room: TriedRoom, drawn: Floats, allowed: Bools, rng: np.random.Generator) -> Ints:
    """An allowed object of the kind that each seen place had (T,); any allowed one where none is of it, -1: none."""
    scene, support = room.scene, np.full(len(drawn), -1, np.int64)
    objects = np.flatnonzero(allowed & room.seen)
    if not len(objects):
        return support
    kinds = np.where(scene.category[objects] < 0, -2, scene.category[objects])
    for kind in np.unique(drawn[:, KIND]):
        mine = np.flatnonzero(drawn[:, KIND] == kind)
        alike = objects[kinds == kind]
        if kind == -1:
            continue
        support[mine] = rng.choice(alike if len(alike) else objects, size=len(mine))
    return support


def _at(scene: ObservedScene, support: Ints, fraction: Floats) -> Floats:
    """Positions (T, 2) at fractions (T, 2) of supports; metres from the room's middle without one."""
    result = scene.room.middle + fraction
    held = np.flatnonzero(support >= 0)
    below = support[held]
    offset = rotate(fraction[held] * scene.half[below, :2], scene.yaw[below])
    result[held] = scene.center[below, :2] + offset
    return np.asarray(result)


def _anywhere(
    scene: ObservedScene, support: Ints, result: Floats, mine: Bools, base: Floats, rng: np.random.Generator
) -> None:
    fraction = rng.uniform(-1, 1, (int(mine.sum()), 2))
    roots = np.flatnonzero(scene.support < 0)
    ground = int(roots[np.argmax(scene.half[roots, :2].prod(axis=1))]) if len(roots) else -1
    result[mine, :2] = _at(scene, np.where(support[mine] < 0, ground, support[mine]), fraction)
    result[mine, 3] += QUARTER * rng.integers(4, size=len(fraction))


def _at_walls(
    walls: RoomWalls, result: Floats, drawn: Floats, half: Floats, mine: Bools, rng: np.random.Generator
) -> None:
    """Along walls drawn by their lengths, on the side of the room's middle or, of a wall within, on either."""
    rows = np.flatnonzero(mine)
    if not len(walls.yaw) or not len(rows):
        return
    wall = walls.drawn(len(rows), rng)
    side = np.where(rotate(walls.middle.mean(axis=0) - walls.middle, -walls.yaw)[:, 1] < 0, -1.0, 1.0)[wall]
    result[rows, :2], result[rows, 3] = walls.along(wall, side, half, drawn[rows, GAP], drawn[rows, WALL_TURN], rng)


def _beside(
    room: TriedRoom,
    result: Floats,
    support: Ints,
    drawn: Floats,
    mine: Bools,
    on_floor: Bools,
    rng: np.random.Generator,
) -> None:
    """At the same pose relative to an object of the category that was near; where there is none, as it was."""
    scene = room.scene
    first = NEAR + PER_NEIGHBOUR * rng.integers(NEIGHBOURS, size=len(drawn))
    for row in np.flatnonzero(mine):
        kind, x, y, turn = drawn[row, first[row] : first[row] + PER_NEIGHBOUR]
        alike = room.seen & (scene.category == kind) & (kind >= 0)
        if not on_floor[row]:
            alike &= scene.support == support[row]
        if alike.any():
            other = int(rng.choice(np.flatnonzero(alike)))
            result[row, :2] = scene.center[other, :2] + rotate(np.array([x, y]), scene.yaw[other])
            result[row, 3] = scene.yaw[other] + turn


def _bottoms(scene: ObservedScene, support: Ints, drawn: Floats) -> Floats:
    """Heights of the bottoms (T,): of the surface nearest to the one it was seen on, or as high as it was."""
    bottom = scene.room.ground + drawn[:, ABOVE]
    for obj in np.unique(support[support >= 0]):
        mine, under = np.flatnonzero(support == obj), float(scene.center[obj, 2] - scene.half[obj, 2])
        bottom[mine] = under + drawn[mine, ABOVE]
        levels = scene.surfaces(int(obj))[:, 0]
        on = mine[drawn[mine, ON_TOP] > 0]
        if len(levels) and len(on):
            bottom[on] = under + levels[np.abs(drawn[on, ABOVE, None] - levels).argmin(axis=1)]
    return np.asarray(bottom)
