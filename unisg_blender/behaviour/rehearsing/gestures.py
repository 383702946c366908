"""Where a hand would bring objects to perform an action: goals in world space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.affine_rows import compose, gather, rotation_and_size
from ...geometry.planar import rotation
from ..fulfilment.action_batch import Batch
from ..fulfilment.body_contact import body_bounds, touching
from ..playing.player import Lesson

_ROUNDS, _HEIGHTS = 4, 40
"""A height is looked for among so many at once, then between two of them, and so on: to less than a micrometre."""


def place_goal(batch: Batch, pair: int, world: NDArray[np.float64]) -> NDArray[np.float64]:
    """World matrix (4, 4) that puts the entity of a pose pair at its reference, with its own scale."""
    poses = batch.poses
    wanted = compose(poses.frames(world), poses.reference)[:, pair : pair + 1]
    own = gather(world, poses.row[pair : pair + 1])
    turn, _, _ = rotation_and_size(wanted)
    now, _, _ = rotation_and_size(own)
    goal = world[poses.row[pair]].copy()
    goal[:3, :3] = _matrix(turn) @ _matrix(now).T @ goal[:3, :3]
    goal[:3, 3] = wanted[3::4, 0]
    return goal


def away_goal(batch: Batch, pair: int, world: NDArray[np.float64]) -> NDArray[np.float64]:
    """World matrix (4, 4) that takes the entity of a pose pair up and away, or turns it where only the angle counts."""
    poses, action = batch.poses, batch.poses.action[pair]
    goal = world[poses.row[pair]].copy()
    if np.isfinite(batch.distance[action]):
        place = compose(poses.frames(world), poses.reference)[3::4, pair]
        goal[:3, 3] = np.maximum(goal[:3, 3], place) * (0, 0, 1) + place * (1, 1, 0)
        goal[2, 3] += 1.2 * batch.distance[action] + 0.05
        return goal
    angle = min(1.2 * batch.angle[action] + 0.05, np.pi)
    reference = rotation_and_size(compose(poses.frames(world), poses.reference)[:, pair : pair + 1])[0]
    own = rotation_and_size(gather(world, poses.row[pair : pair + 1]))[0]
    goal[:3, :3] = rotation(angle) @ _matrix(reference) @ _matrix(own).T @ goal[:3, :3]
    return goal


def touch_goals(
    lesson: Lesson, tool: int, target: int, distance: float, world: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """World matrices of a tool just above a target, clear of it, and in contact with it.

    The tool comes straight down on the middle of the target and stops where the
    boxes meet (within ``distance`` metres), a thousandth further to be sure.
    """
    bounds = body_bounds(lesson.graph, np.array([tool, target]))
    pose = gather(world, np.array([tool, target]))
    middle = [pose[:, k].reshape(3, 4) @ np.append(bounds[:3, k], 1) for k in range(2)]
    reach = [np.linalg.norm(pose[:, k].reshape(3, 4)[:, :3]) * np.linalg.norm(bounds[3:, k]) for k in range(2)]
    top = float(sum(reach)) + distance + 0.05

    def lifted(height: float) -> NDArray[np.float64]:
        """The tool's pose (4, 4) with its middle so many metres over the target's."""
        goal = world[tool].copy()
        goal[:3, 3] += middle[1] - middle[0] + (0, 0, height)
        return goal

    low, high, same = 0.0, top, np.zeros(_HEIGHTS, np.int64)
    for _ in range(_ROUNDS):
        heights = np.linspace(low, high, _HEIGHTS + 1)
        there = gather(np.stack([lifted(height) for height in heights[1:]]), np.arange(_HEIGHTS))
        near = touching(there, bounds[:, same], pose[:, same + 1], bounds[:, same + 1], distance + np.zeros(_HEIGHTS))
        last = _HEIGHTS if near.all() else int(near.argmin())
        low, high = heights[last], heights[min(last + 1, _HEIGHTS)]
    return lifted(min(low + 0.06, top)), lifted(max(low - 0.001, 0.0))


def _matrix(columns: NDArray[np.float64]) -> NDArray[np.float64]:
    return columns.reshape(3, 3).T
