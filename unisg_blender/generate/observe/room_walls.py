"""The walls around a place: how far, and where they face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Floats
from ...geometry.planar import rotate, turned_reach
from .observed_scene import ObservedScene
from .prior_tables import PriorTables


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
            half = np.where(shape.swap[walls, None], scene.half[walls, 1::-1], scene.half[walls, :2])
            return RoomWalls(scene.center[walls, :2], scene.yaw[walls] + shape.swap[walls] * (np.pi / 2), half)
        floors = np.flatnonzero(scene.support < 0)
        if not len(floors):
            return RoomWalls(np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2)))
        floor = int(floors[np.argmax(scene.half[floors, :2].prod(axis=1))])
        sides, (x, y) = np.array([[1, 0], [0, 1], [-1, 0], [0, -1.0]]), scene.half[floor, :2]
        middle = scene.center[floor, :2] + rotate(sides * (x, y), np.full(4, scene.yaw[floor]))
        return RoomWalls(middle, scene.yaw[floor] + np.pi / 2 * np.array([1, 0, 1, 0]), np.array([[y, 0], [x, 0]] * 2))

    def gaps(self, places: Floats, half: Floats) -> tuple[Floats, Floats]:
        """Clearance of a footprint at places (T, 4) from each wall, metres, and the heading of the wall's normal that
        looks to the place, radians, both (T, W)."""
        local = rotate(places[:, None, :2] - self.middle, -self.yaw)
        reach = turned_reach(half[:2], places[:, 3:] - self.yaw)
        side = np.where(local[..., 1] < 0, -1.0, 1.0)
        beyond = np.abs(local) - self.half - reach
        gap = np.where(beyond[..., 0] > 0, np.hypot(beyond[..., 0], np.maximum(beyond[..., 1], 0)), beyond[..., 1])
        return gap, self.yaw + side * (np.pi / 2)
