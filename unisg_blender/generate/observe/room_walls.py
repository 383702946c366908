"""The walls around a place: how far, and where they face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Floats, Ints
from ...geometry.planar import rotate, turned_reach
from .observed_scene import ObservedScene
from .prior_tables import PriorTables

QUARTER = np.pi / 2


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
