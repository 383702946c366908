"""How far entities are from where an action wants them: metres and radians, in world space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .batch import Batch
from .components import compose, gather, length, rotation_and_size, transform, turn_between
from .contact import EPSILON
from .moment import Moment


def deviation(batch: Batch, moment: Moment) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distance in metres and angle in radians of the batch's poses from the places asked for; each (P,).

    The angle is 0 where it decides nothing: where none is asked for, or the distance is too large.
    """
    limit = batch.distance[batch.poses.action] + EPSILON
    return _compare(batch, moment, np.isfinite(batch.angle[batch.poses.action]), limit)


def away_by(batch: Batch, moment: Moment) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distance and angle of all of the batch's poses from the places asked for; each (P,)."""
    count = len(batch.poses.action)
    return _compare(batch, moment, np.ones(count, bool), np.full(count, np.inf))


def _compare(
    batch: Batch, moment: Moment, asked: NDArray[np.bool_], limit: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    poses = batch.poses
    frames = poses.frames(moment.world)
    distance = length(moment.world[poses.row, :3, 3].T - transform(frames, poses.reference[3::4]))
    angle = np.zeros(len(distance))
    pairs = np.flatnonzero(asked & (distance <= limit))
    if len(pairs):
        wanted = compose(frames.take(pairs, 1), poses.reference.take(pairs, 1))
        pose = gather(moment.world, poses.row[pairs])
        angle[pairs] = turn_between(rotation_and_size(pose)[0], rotation_and_size(wanted)[0])
    return distance, angle
