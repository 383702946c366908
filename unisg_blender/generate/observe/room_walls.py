"""The walls around a place: how far, and where they face."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.planar import rotate, turned_reach
from .observed_scene import ObservedScene
from .prior_tables import PriorTables

QUARTER = np.pi / 2

WITHIN = 0.1
"""Metres that a door may stand out of its wall."""

RAYS = np.array([[np.cos(a), np.sin(a)] for a in 0.3 + 2 * np.pi * np.arange(7) / 7])
"""Ways (7, 2) in which one looks from a place, along no wall of a room that is drawn at a right angle."""


@dataclass(frozen=True, eq=False)
class RoomWalls:
    """W walls seen from above: middles (W, 2), turns of their lengths (W,), half lengths and thicknesses (W, 2).

    In a scene without walls the sides of its largest floor stand for them.
    """

    middle: Floats
    yaw: Floats
    half: Floats

    @staticmethod
    def of(scene: ObservedScene, tables: PriorTables) -> RoomWalls:
        """The walls of a scene: what is as thin, long and tall as a wall, and part of the building or unknown."""
        shape = scene.room
        walls = np.flatnonzero((shape.inner != 0) & (tables.structural[scene.category] | (scene.category < 0)))
        if len(walls):
            return RoomWalls.of_objects(scene, walls)
        floors = np.flatnonzero(scene.support < 0)
        if not len(floors):
            return RoomWalls(np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2)))
        floor = int(floors[np.argmax(scene.half[floors, :2].prod(axis=1))])
        sides, (x, y) = np.array([[1, 0], [0, 1], [-1, 0], [0, -1.0]]), scene.half[floor, :2]
        middle = scene.center[floor, :2] + rotate(sides * (x, y), np.full(4, scene.yaw[floor]))
        return RoomWalls(middle, scene.yaw[floor] + QUARTER * np.array([1, 0, 1, 0]), np.array([[y, 0], [x, 0]] * 2))

    @staticmethod
    def of_objects(scene: ObservedScene, walls: Ints) -> RoomWalls:
        """Some objects (W,) of a scene as walls."""
        swap = scene.room.swap[walls]
        half = np.where(swap[:, None], scene.half[walls, 1::-1], scene.half[walls, :2])
        return RoomWalls(scene.center[walls, :2], scene.yaw[walls] + swap * QUARTER, half)

    def drawn(self, count: int, rng: np.random.Generator) -> Ints:
        """Walls (T,) drawn by their lengths."""
        return rng.choice(len(self.yaw), size=count, p=self.half[:, 0] / self.half[:, 0].sum())

    def along(
        self, wall: Ints, side: Floats, half: Floats, gap: Floats | float, turn: Floats | float,
        rng: np.random.Generator,
    ) -> tuple[Floats, Floats]:  # fmt: skip
        """Places somewhere along walls (T,): positions (T, 2) and headings (T,) of a footprint of half extents.

        ``side`` (T,) is 1 or -1, ``gap`` metres between wall and footprint, ``turn`` radians from the wall's normal.
        """
        yaw = self.yaw[wall] + side * QUARTER + turn
        reach = turned_reach(half[:2], yaw - self.yaw[wall])
        room = np.maximum(self.half[wall, 0] - reach[:, 0], 0)
        local = np.column_stack([rng.uniform(-room, room), side * (self.half[wall, 1] + reach[:, 1] + gap)])
        return self.middle[wall] + rotate(local, self.yaw[wall]), yaw

    def gaps(self, places: Floats, half: Floats) -> tuple[Floats, Floats]:
        """Clearance of a footprint at places (T, 4) from each wall, metres, and the heading of the wall's normal that
        looks to the place, radians, both (T, W)."""
        local = rotate(places[:, None, :2] - self.middle, -self.yaw)
        reach = turned_reach(half[:2], places[:, 3:] - self.yaw)
        side = np.where(local[..., 1] < 0, -1.0, 1.0)
        beyond = np.abs(local) - self.half - reach
        gap = np.where(beyond[..., 0] > 0, np.hypot(beyond[..., 0], np.maximum(beyond[..., 1], 0)), beyond[..., 1])
        return gap, self.yaw + side * QUARTER

    def inside(self, places: Floats) -> Bools:
        """Which places (T, 2) the walls enclose: most ways from there cross an odd number of walls."""
        start, edge = self._edges
        across = RAYS[:, None, 0] * edge[:, 1] - RAYS[:, None, 1] * edge[:, 0]
        offset = start - places[:, None]
        cross = offset[..., 0] * edge[:, 1] - offset[..., 1] * edge[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            far = cross[:, None] / across
            share = (offset[:, None, :, 0] * RAYS[:, None, 1] - offset[:, None, :, 1] * RAYS[:, None, 0]) / across
        met = (far > 0) & (share >= 0) & (share < 1)
        return np.asarray((met.sum(axis=2) % 2).sum(axis=1) > len(RAYS) / 2)

    @cached_property
    def _edges(self) -> tuple[Floats, Floats]:
        """Starts and ways (E, 2) along the middles of the walls, up to those around their corners; doors and windows,
        which lie within another wall, are left out."""
        local = np.abs(
            rotate(self.middle[None] - self.middle[:, None], np.broadcast_to(-self.yaw[:, None], (len(self.yaw),) * 2))
        )
        reach = self.half[:, None] - np.array([1, -1]) * self.half[None] + WITHIN
        held = (local <= reach).all(axis=2) & (self.half[:, None, 0] > self.half[None, :, 0])
        walls = ~held.any(axis=0)
        along = np.column_stack([np.cos(self.yaw), np.sin(self.yaw)])[walls]
        reach = self.half[walls].sum(axis=1, keepdims=True)
        return self.middle[walls] - along * reach, 2 * along * reach
