"""Screw interpolation and keyframe reduction of animated objects and bones.

Blender plays F-curves, channel by channel, and knows no screws: so the keys that
are written carry handles which make the curves follow the motion, and the error
reported is measured on the curves as Blender evaluates them.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...poses import compose, cubic_sclerp, inverse, log, pose_errors, rebuild, reduce_keyframes, third_poses
from ..fcurves import Floats, Item
from .keyframes import animated, key_count, key_times, plain, read_motors, restore_keys, save_keys
from .keyframes import write_motors as write


@dataclass(frozen=True)
class Tolerance:
    """What a frame may be off: ``metres`` per Blender unit turn lengths into millimetres."""

    millimetres: float
    degrees: float
    metres: float = 1.0


@dataclass(frozen=True)
class MotionReport:
    """What happened to one item's keys; errors are the largest over all frames."""

    name: str
    keys_before: int
    keys_after: int
    millimetres: float
    degrees: float
    changed: bool = True
    long_turns: int = 0


def interpolate_with_motors(item: Item, tolerance: Tolerance) -> MotionReport:
    """Let an item move along screws between its keyed poses.

    Keys are the frames at which any location or rotation channel has one. Where three
    cubics per span do not follow the screw within tolerance, keys on the screw are added.

    Parameters
    ----------
    item
        Object or pose bone with an action.
    tolerance
        How far the curves may be from the screws.

    Returns
    -------
    MotionReport
        ``long_turns`` counts spans that turned more than half a turn and now take the short way.

    Raises
    ------
    UniSGError
        No keys to interpolate, or curves that are more than keys; nothing is changed.
    """
    times = _checked_times(item)
    frames = _frames(times)
    before, at_keys = read_motors(item, frames), read_motors(item, times)
    wanted = rebuild(frames, times, at_keys)
    keys, count = np.searchsorted(frames, times), key_count(item)
    errors = _fit(item, frames, wanted, keys, tolerance)
    return MotionReport(item.name, count, key_count(item), *errors, long_turns=_long_turns(before, keys))


def reduce_item_keyframes(item: Item, tolerance: Tolerance) -> MotionReport:
    """Replace an item's keys by few, from which its motion comes back within tolerance.

    The motion is what the curves give at every whole frame and at every key. Keys are chosen so
    that ``cubic_sclerp`` rebuilds it, handles so that the curves do. An item whose keys cannot be
    made fewer stays as it is (``changed`` False). A channel that never changes keeps one key.

    Parameters
    ----------
    item
        Object or pose bone with an action.
    tolerance
        How far any frame may come to lie from where it was.

    Returns
    -------
    MotionReport
        Keys and errors.

    Raises
    ------
    UniSGError
        As ``interpolate_with_motors``.
    """
    frames = _frames(_checked_times(item))
    wanted, count, saved = read_motors(item, frames), key_count(item), save_keys(item)
    millimetres = tolerance.millimetres / tolerance.metres
    keys = reduce_keyframes(frames, wanted, millimetres, tolerance.degrees, interpolate=cubic_sclerp)[0]
    errors = _fit(item, frames, wanted, keys, tolerance, still_once=True)
    if key_count(item) < count:
        return MotionReport(item.name, count, key_count(item), *errors)
    restore_keys(item, saved)
    return MotionReport(item.name, count, count, 0.0, 0.0, changed=False)


def _checked_times(item: Item) -> Floats:
    if not animated(item):
        raise UniSGError(f"{item.name} has no location or rotation keys: insert keys first")
    if not plain(item):
        raise UniSGError(f"{item.name} has F-curve modifiers or baked samples: bake them to keys first")
    times = key_times(item)
    if len(times) < 2:
        raise UniSGError(f"{item.name} has keys at one frame only: insert a second one")
    return times


def _frames(times: Floats) -> Floats:
    """Every whole frame from the first key to the last, and the keys."""
    return np.union1d(times, np.arange(np.ceil(times[0]), np.floor(times[-1]) + 1))


def _fit(
    item: Item, frames: Floats, wanted: Floats, keys: NDArray[np.int64], tolerance: Tolerance, still_once: bool = False
) -> tuple[float, float]:
    """Write keys, measure, and add the worst frame of every span that is off, until none is."""
    while True:
        write(item, frames[keys], wanted[keys], third_poses(frames, wanted, keys), still_once)
        distance, angle = pose_errors(read_motors(item, frames), wanted)
        errors = distance * tolerance.metres * 1e3, np.degrees(angle)
        excess = np.maximum(errors[0] / tolerance.millimetres, errors[1] / tolerance.degrees)
        excess[keys] = 0.0  # what is off at a key is rounding of Blender's single precision
        added = [split for a, b in itertools.pairwise(keys) for split in _splits(frames, excess, a, b)]
        if not added:
            return float(errors[0].max()), float(errors[1].max())
        keys = np.union1d(keys, added)


def _splits(frames: Floats, excess: Floats, start: int, stop: int) -> list[int]:
    """Where to cut a span that is off: in equal parts, as the error of a cubic falls with the fourth power."""
    worst = float(excess[start:stop].max())
    if worst <= 1.0:
        return []
    parts = max(2, min(int(np.ceil(worst**0.25)), stop - start))
    cuts = np.linspace(frames[start], frames[stop], parts + 1)[1:-1]
    nearest = np.abs(frames[start + 1 : stop, None] - cuts).argmin(axis=0) + start + 1
    return [int(frame) for frame in nearest]


def _long_turns(motors: Floats, keys: NDArray[np.int64]) -> int:
    """Spans between keys over which a motion turned more than half a turn."""
    turns = np.linalg.norm(log(compose(inverse(motors[:-1]), motors[1:]))[:, :3], axis=1)
    return sum(turns[a:b].sum() > np.pi + 1e-3 for a, b in itertools.pairwise(keys))
