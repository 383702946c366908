"""Keyframe reduction: few keys from which screw interpolation rebuilds a dense motion.

Keys are frames of the motion itself, taken greedily: from each key on, the
furthest frame that a screw still reaches with every frame between within
tolerance. All bodies advance together, so that many cost little more than one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .arrays import PoseError
from .forms import FORMS, convert
from .motion import PIVOT, compose, cubic_sclerp, inverse, log, motors_of, sclerp

Errors = tuple[np.ndarray, np.ndarray]
Interpolation = Callable[..., Any]


class _Dense(NamedTuple):
    """A motion (frames, groups, bodies of a group, 8) to be reduced; tolerance in metres and radians."""

    times: np.ndarray
    motion: np.ndarray
    tolerance: tuple[float, float]
    interpolate: Interpolation


def pose_errors(poses: Any, reference: Any, form: str = PIVOT) -> Errors:
    """Distance (metres) and angle (radians) between poses; scale is not looked at.

    Parameters
    ----------
    poses, reference
        Shapes (..., width of ``form``), broadcast against each other.

    Returns
    -------
    distance, angle : ndarray
        Shape (...): between the two origins, and of the turn from one to the other in [0, pi].
    """
    a, b = convert(poses, form, PIVOT), convert(reference, form, PIVOT)
    turn = log(compose(inverse(a), b))[..., :3]
    apart = FORMS[PIVOT].decode(a)[..., :3, 3] - FORMS[PIVOT].decode(b)[..., :3, 3]
    return np.linalg.norm(apart, axis=-1), np.linalg.norm(turn, axis=-1)


def rebuild(
    times: Any, key_times: Any, keys: Any, form: str = PIVOT, interpolate: Interpolation = sclerp
) -> np.ndarray:
    """Poses at any times from keys, by screw interpolation; the first and last key hold outside.

    Parameters
    ----------
    times
        Shape (T,).
    key_times
        Shape (K,), rising; K at least 1.
    keys
        Shape (K, ..., width of ``form``).
    interpolate
        ``sclerp`` or another function of its arguments.

    Returns
    -------
    ndarray
        Shape (T, ..., width).
    """
    key_times, keys = np.asarray(key_times, dtype=np.float64), np.asarray(keys)
    if len(key_times) != len(keys) or not len(keys) or not (np.diff(key_times) > 0).all():
        raise PoseError("keys need rising times, one for each key, and at least one")
    span, fraction = _spans(times, key_times, keys)
    return interpolate(keys[span], keys[np.minimum(span + 1, len(keys) - 1)], fraction, form)


def third_poses(times: Any, poses: Any, keys: Any, form: str = PIVOT) -> np.ndarray:
    """Poses of a dense motion at the thirds of the spans between keys: shape (2, K - 1, ..., width).

    With the keys they say the path of ``cubic_sclerp``. Arguments as in ``reduce_keyframes``.
    """
    times = np.asarray(times, dtype=np.float64)
    begin, length = times[keys[:-1]], np.diff(times[keys])
    return np.stack([rebuild(begin + third * length, times, poses, form) for third in (1 / 3, 2 / 3)])


def rebuild_cubic(times: Any, key_times: Any, keys: Any, thirds: Any, form: str = PIVOT) -> np.ndarray:
    """As ``rebuild``, along ``cubic_sclerp`` through keys (K, ..., width) and ``third_poses``; K at least 2."""
    span, fraction = _spans(times, np.asarray(key_times, dtype=np.float64), np.asarray(keys))
    return cubic_sclerp(keys[span], thirds[0][span], thirds[1][span], keys[span + 1], fraction, form)


def reduce_keyframes(
    times: Any,
    poses: Any,
    millimetres: float,
    degrees: float,
    form: str = PIVOT,
    shared: bool = False,
    interpolate: Interpolation = sclerp,
) -> list[np.ndarray]:
    """Frames to keep as keys, for each body.

    Parameters
    ----------
    times
        Shape (F,), rising: one per frame.
    poses
        Shape (F, N, width of ``form``) or (F, width): the dense motion of N bodies.
    millimetres, degrees
        What every frame may be off, in place (of the body's origin) and in turn, when
        ``rebuild`` interpolates the keys.
    form
        Name in ``FORMS``.
    shared
        Whether all bodies keep the same frames.
    interpolate
        What will rebuild the motion: ``sclerp`` or another function of its arguments, for ``rebuild``; or
        ``cubic_sclerp``, for ``rebuild_cubic`` with ``third_poses``: fewer keys where speeds change smoothly.

    Returns
    -------
    list of ndarray
        One array of frame numbers per body (one in all if ``shared``), rising; the first
        and the last frame are always in.

    Raises
    ------
    PoseError
        Wrong shapes, times that do not rise, or a tolerance that is not positive.
    """
    times, motion = _checked(times, poses, millimetres, degrees, form)
    motion = motion[:, None] if shared else motion[:, :, None]  # (frames, groups, bodies of a group, 8)
    tolerance = (millimetres * 1e-3, float(np.radians(degrees)))
    dense = _Dense(times, motion, tolerance, interpolate)
    frames, groups = motion.shape[:2]
    keys: list[list[int]] = [[0] for _ in range(groups)]
    start = np.zeros(groups, dtype=np.int64)
    while (active := np.flatnonzero(start < frames - 1)).size:
        reach = _furthest(dense, active, start[active])
        start[active] = reach
        for group, frame in zip(active, reach, strict=True):
            keys[group].append(int(frame))
    return [np.array(k) for k in keys]


def _spans(times: Any, key_times: np.ndarray, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each time the number of its span, and the fraction of it, shaped to broadcast against keys[span]."""
    times = np.clip(np.asarray(times, dtype=np.float64), key_times[0], key_times[-1])
    span = np.clip(np.searchsorted(key_times, times, side="right") - 1, 0, max(len(keys) - 2, 0))
    length = np.append(np.diff(key_times), 1.0)[span]
    return span, ((times - key_times[span]) / length).reshape(-1, *(1,) * (keys.ndim - 2))


def _checked(times: Any, poses: Any, millimetres: float, degrees: float, form: str) -> tuple[np.ndarray, np.ndarray]:
    times, motion = np.asarray(times, dtype=np.float64), motors_of(np.asarray(poses), form)
    if motion.ndim == 2:
        motion = motion[:, None]
    if motion.ndim != 3 or times.shape != (len(motion),) or len(motion) == 0:
        raise PoseError(f"a motion is poses (frames, bodies, width) with one time per frame, not {np.shape(poses)}")
    if not (np.diff(times) > 0).all():
        raise PoseError("the times of a motion must rise")
    if not (millimetres > 0 and degrees > 0):
        raise PoseError("tolerances must be positive: millimetres, degrees")
    return times, motion.astype(np.float64)


def _furthest(dense: _Dense, groups: np.ndarray, start: np.ndarray) -> np.ndarray:
    """For each group, the last frame found that a screw from ``start`` reaches within tolerance.

    Doubles the step until it fails, then halves the gap. A step of one frame always fits.
    """
    last = len(dense.times) - 1
    good, bad = start + 1, np.full_like(start, last + 1)
    step = np.ones_like(start)
    while (open_ := np.flatnonzero(bad - good > 1)).size:
        growing = bad[open_] > last
        trial = np.where(growing, np.minimum(good[open_] + step[open_], last), (good[open_] + bad[open_]) // 2)
        fit = _segment_fits(dense, groups[open_], start[open_], trial)
        step[open_] *= 2
        good[open_] = np.where(fit, trial, good[open_])
        bad[open_] = np.where(fit, bad[open_], trial)
    return good


def _segment_fits(dense: _Dense, groups: np.ndarray, start: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """Whether the path between two frames of each group stays within tolerance of all frames between."""
    count = stop - start - 1
    segment = np.repeat(np.arange(len(groups)), count)
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    frame = start[segment] + 1 + np.arange(len(segment)) - first[segment]
    group, begin, end = groups[segment], start[segment], stop[segment]
    times, motion, tolerance, interpolate = dense
    fraction = (times[frame] - times[begin]) / (times[end] - times[begin])
    first, last = motion[begin, group], motion[end, group]
    if interpolate is cubic_sclerp:
        one, two = (_poses_at(dense, groups, times[start] + w * (times[stop] - times[start])) for w in (1 / 3, 2 / 3))
        rebuilt = cubic_sclerp(first, one[segment], two[segment], last, fraction[:, None])
    else:
        rebuilt = interpolate(first, last, fraction[:, None])
    distance, angle = pose_errors(rebuilt, motion[frame, group])
    off = (distance > tolerance[0]).any(1) | (angle > tolerance[1]).any(1)
    return np.bincount(segment, weights=off, minlength=len(groups)) == 0


def _poses_at(dense: _Dense, groups: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Poses of each group at one time each, between frames along screws: (segments, bodies of a group, 8)."""
    before = np.clip(np.searchsorted(dense.times, times, side="right") - 1, 0, len(dense.times) - 2)
    fraction = (times - dense.times[before]) / (dense.times[before + 1] - dense.times[before])
    return sclerp(dense.motion[before, groups], dense.motion[before + 1, groups], fraction[:, None])
