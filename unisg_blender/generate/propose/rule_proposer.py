"""Places by rules that need no training: at walls, on the floor, on top of furniture, with room to stand before it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...geometry.arrays import Floats
from ...geometry.planar import rotate, turned_reach
from ..observe.observed_scene import ObservedScene
from ..observe.room_walls import QUARTER, RoomWalls
from .proposer import Proposals, Proposer, Query

TO_WALL = 0.01
"""Metres between a wall and the back of what stands at it."""

BEFORE = 0.6
"""Metres that are to be free before a thing."""

DRAWN = 6
"""How many times as many places are drawn; those with the most room before them come first."""

CLEAR_OF_DOORS = 0.9
"""Metres before a door that stay free."""


class RuleProposer(Proposer):
    """Proposes by the usual place of a category: "wall", "floor" or "top".

    Parameters
    ----------
    places
        By number of the category.
    door
        Number of the category of doors, -1 for none.
    """

    def __init__(self, places: Mapping[int, str], door: int = -1) -> None:
        self.places, self.door = places, door

    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """See :class:`~.proposer.Proposer`."""
        scene, half, kind = query.scene, query.placeable.half, self.places[query.category]
        holders = np.flatnonzero(query.allowed)
        if not len(holders):
            return Proposals(np.full(count, -1), _around(scene.room.middle, scene.room.ground, count, rng))
        walls = np.flatnonzero(scene.room.inner != 0)
        if kind == "top":
            return _on_top(scene, rng.choice(holders, count), rng)
        floor = int(holders[np.argmax(scene.half[holders, :2].prod(axis=1))])
        made = _at_walls if kind == "wall" and len(walls) else _on_floor
        places = made(scene, floor, walls, half, DRAWN * count, rng)
        places = places[np.argsort(self._crowded(scene, half, places), kind="stable")][:count]
        return Proposals(np.full(count, floor), places)

    def _crowded(self, scene: ObservedScene, half: Floats, places: Floats) -> Floats:
        """How much stands before things at places (T, 4), and whether they stand before a door; 0 is best, (T,)."""
        front = places[:, :2] + rotate(np.array([[0.0, -(half[1] + BEFORE / 2)]]), places[:, 3])
        reach = turned_reach(np.array([half[0], BEFORE / 2]), places[:, 3])
        stands = (scene.support >= 0) & (scene.room.inner == 0) & (scene.half[:, 2] > 0.1)
        own = turned_reach(scene.half[:, :2], scene.yaw)
        apart = np.abs(front[:, None] - scene.center[None, :, :2]) - reach[:, None] - own[None]
        crowded = ((apart < 0).all(axis=2) & stands).sum(axis=1).astype(float)
        doors = scene.category == self.door
        if self.door >= 0 and doors.any():
            body = turned_reach(half[:2], places[:, 3])
            gap = np.abs(places[:, None, :2] - scene.center[doors][None, :, :2]) - body[:, None] - own[doors][None]
            crowded += 10.0 * (gap.max(axis=2) < CLEAR_OF_DOORS).any(axis=1)
        return crowded


def _at_walls(
    scene: ObservedScene, floor: int, walls: np.ndarray, half: Floats, count: int, rng: np.random.Generator
) -> Floats:
    """Places with the back to a wall, the front into the room."""
    sides = RoomWalls.of_objects(scene, walls)
    wall = sides.drawn(count, rng)
    middle, yaw = sides.along(wall, scene.room.inner[walls[wall]], half, TO_WALL, QUARTER, rng)
    return np.column_stack([middle, np.full(count, _top(scene, floor)), yaw])


def _on_floor(
    scene: ObservedScene, floor: int, walls: np.ndarray, half: Floats, count: int, rng: np.random.Generator
) -> Floats:
    """Places anywhere on a floor, along the walls' directions."""
    local = rng.uniform(-1, 1, (count, 2)) * np.maximum(scene.half[floor, :2] - half[:2].max(), 0)
    middle = scene.center[floor, :2] + rotate(local, float(scene.yaw[floor]))
    base = float(scene.yaw[walls[0]]) if len(walls) else float(scene.yaw[floor])
    return np.column_stack([middle, np.full(count, _top(scene, floor)), base + rng.integers(4, size=count) * QUARTER])


def _on_top(scene: ObservedScene, holders: np.ndarray, rng: np.random.Generator) -> Proposals:
    """Places on the upper sides of holders (T,), turned as these are."""
    local = rng.uniform(-0.8, 0.8, (len(holders), 2)) * scene.half[holders, :2]
    middle = scene.center[holders, :2] + rotate(local, scene.yaw[holders])
    top = scene.center[holders, 2] + scene.half[holders, 2]
    return Proposals(holders, np.column_stack([middle, top, scene.yaw[holders]]))


def _around(middle: Floats, ground: float, count: int, rng: np.random.Generator) -> Floats:
    places = np.column_stack([middle + rng.normal(0, 1, (count, 2)), np.full(count, ground), np.zeros(count)])
    return np.asarray(places)


def _top(scene: ObservedScene, floor: int) -> float:
    return float(scene.center[floor, 2] + scene.half[floor, 2])
