"""A small room as boxes, for tests that say the right value of everything in it."""

from __future__ import annotations

import numpy as np

from unisg_blender.generate.observe.observed_scene import ObservedScene
from unisg_blender.geometry.boxes import Boxes

VOCABULARY = ["Floor", "Wall", "Door", "Table", "Cup", "Chair"]
FLOOR, WALL, DOOR, TABLE, CUP, CHAIR = range(6)
BUILDING = (FLOOR, WALL, DOOR)
Things = list[tuple[int, int, tuple[float, float, float], tuple[float, float, float], float]]

# category, support, centre, half extents, turn
THINGS: Things = [
    (FLOOR, -1, (0.3, -0.2, -0.05), (3.1, 2.4, 0.05), 0.0),
    (WALL, 0, (0.3, 2.25, 1.25), (3.1, 0.05, 1.25), 0.0),
    (WALL, 0, (-2.85, -0.2, 1.25), (0.05, 2.4, 1.25), 0.0),
    (DOOR, 1, (1.2, 2.25, 1.0), (0.45, 0.06, 1.0), 0.0),
    (TABLE, 0, (-0.6, 0.4, 0.4), (0.7, 0.4, 0.4), 0.4),
    (CUP, 4, (-0.5, 0.45, 0.86), (0.05, 0.04, 0.06), 1.1),
    (CUP, 4, (-0.9, 0.3, 0.86), (0.05, 0.04, 0.06), -0.3),
    (CHAIR, 0, (-0.7, -0.5, 0.45), (0.25, 0.3, 0.45), 2.9),
    (CHAIR, 0, (1.6, -1.2, 0.45), (0.25, 0.3, 0.45), -1.3),
    (-1, 0, (1.9, 0.9, 0.3), (0.3, 0.2, 0.3), 0.7),
]


def observed(things: Things) -> ObservedScene:
    category, support, center, half, yaw = (np.array(column) for column in zip(*things, strict=True))
    nothing = Boxes(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 3)), np.zeros(0, bool))
    world, none = np.tile(np.eye(4), (len(things), 1, 1)), np.full(len(things), -1)
    return ObservedScene(category, support, world, center, half, yaw, none, lambda obj: nothing)
