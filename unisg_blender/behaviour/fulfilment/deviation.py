"""How far entities are from where an action wants them: metres and radians, in world space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.affine_rows import (
    Array,
    compose,
    gather,
    length,
    linear,
    rotation_and_size,
    some,
    transform,
    turn_between,
)
from ...geometry.angle_test import compose_turns, plainly_turned
from .action_batch import Batch, Poses
from .body_contact import EPSILON
from .snapshot import Moment

_FEW = 0.5
"""If less than this part of the poses is of interest, they are picked out first."""


def placed(batch: Batch, moment: Moment) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which of the batch's poses are where they are wanted, and which are not; both bool (P,).

    Wanted is: within the distance and the angle of their action, the limits included.
    What is no number is neither.
    """
    poses = batch.poses
    frames, own = poses.frames(moment.world), gather(moment.world, poses.row)
    distance = length(own[3::4] - transform(frames, poses.reference[3::4]))
    limit = poses.distance + EPSILON
    there, away = distance <= limit, distance > limit
    asked = np.flatnonzero(there & poses.turns)
    if len(asked):
        places = asked if len(asked) < _FEW * len(there) else np.arange(len(there))
        less, more = _turned(poses, places, some(own, places), some(frames, places))
        decides = np.zeros(len(there), bool)
        decides[asked] = True
        decides = decides[places]
        away[places] |= decides & more
        there[places] &= ~decides | less
    return there, away


def _turned(
    poses: Poses, places: NDArray[np.integer], own: Array, frames: Array
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether poses are turned by at most their angle, and by more; both bool."""
    reference = some(poses.reference, places)
    wanted = compose_turns(linear(frames), linear(reference))
    less, more = plainly_turned(linear(own), wanted, poses.trace[places])
    doubt = np.flatnonzero(~(less | more))
    if len(doubt):
        turn = _angle(own.take(doubt, 1), frames.take(doubt, 1), reference.take(doubt, 1))
        limit = poses.angle[places[doubt]] + EPSILON
        less[doubt], more[doubt] = turn <= limit, turn > limit
    return less, more


def away_by(batch: Batch, moment: Moment) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distance in metres and angle in radians of all of the batch's poses from the places asked for; each (P,)."""
    poses = batch.poses
    frames, own = poses.frames(moment.world), gather(moment.world, poses.row)
    distance = length(own[3::4] - transform(frames, poses.reference[3::4]))
    return distance, _angle(own, frames, poses.reference)


def _angle(own: Array, frames: Array, reference: Array) -> Array:
    return turn_between(rotation_and_size(own)[0], rotation_and_size(compose(frames, reference))[0])
