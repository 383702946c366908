"""Location and rotation F-curves of objects and pose bones, read as motors and written with fitted handles.

Motors are unit dual quaternions, float64, in the
space of the item's own channels (``matrix_basis`` without delta transforms).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from mathutils import Euler, Quaternion
from numpy.typing import NDArray

from ...poses import FORMS, convert, third_poses
from ..fcurves import Floats, Item, continuous_signs, curves_of

PATHS = {"QUATERNION": "rotation_quaternion", "AXIS_ANGLE": "rotation_axis_angle"}
STATE = (
    "co",
    "handle_left",
    "handle_right",
    "handle_left_type",
    "handle_right_type",
    "interpolation",
    "easing",
    "type",
)
FREE, BEZIER = 0, 2  # of Blender's enums, as foreach_set wants them
SINGLE = 6e-8  # rounding of the single precision in which Blender keeps curves
SAME = 1e-9  # a channel without a curve gets none while its values differ less


@dataclass(frozen=True)
class Channel:
    """One number of an item's location or rotation."""

    path: str
    index: int
    value: float
    curve: bpy.types.FCurve | None


def channels_of(item: Item) -> list[Channel]:
    """Three channels of location, then the three or four of the item's rotation mode."""
    curves = curves_of(item)
    prefix = f"{item.path_from_id()}." if isinstance(item, bpy.types.PoseBone) else ""
    channels = []
    for name in ("location", PATHS.get(item.rotation_mode, "rotation_euler")):
        for index, value in enumerate(getattr(item, name)):
            curve = None if curves is None else curves.find(prefix + name, index=index)
            channels.append(Channel(prefix + name, index, value, curve))
    return channels


def animated(item: Item) -> bool:
    """Whether a curve moves or turns the item."""
    return any(channel.curve is not None for channel in channels_of(item))


def key_times(item: Item) -> Floats:
    """Frames at which any location or rotation channel has a key, rising."""
    return np.unique([point.co.x for curve in _curves(item) for point in curve.keyframe_points])


def key_count(item: Item) -> int:
    """Number of keys in all location and rotation channels."""
    return sum(len(curve.keyframe_points) for curve in _curves(item))


def plain(item: Item) -> bool:
    """Whether keys alone say the motion: no modifiers, no baked samples, no drivers in the way."""
    return all(not curve.modifiers and len(curve.keyframe_points) for curve in _curves(item))


def read_motors(item: Item, frames: Floats) -> Floats:
    """Motors (F, 8) that the curves give at frames (F,), fractions of frames included."""
    columns = [
        [channel.curve.evaluate(frame) for frame in frames]
        if channel.curve is not None
        else [channel.value] * len(frames)
        for channel in channels_of(item)
    ]
    values = np.array(columns, dtype=np.float64).T.reshape(len(frames), len(columns))
    return _to_motors(values, item.rotation_mode)


def write_motors(
    item: Item, frames: Floats, motors: Floats, thirds: Floats | None = None, still_once: bool = False
) -> None:
    """Replace the location and rotation keys by these.

    Each span of each channel is the cubic through the values at its thirds, which a Bezier
    span with handles at its thirds plays exactly.

    Parameters
    ----------
    item
        With an action.
    frames
        Shape (K,), rising, K at least 1.
    motors
        Shape (K, 8).
    thirds
        Shape (2, K - 1, 8): where the motion is at one and at two thirds of each span; on the
        screws between the keys when omitted.
    still_once
        Whether a channel that does not change gets one key only.
    """
    start = read_channel_values(item, frames[:1])[0]
    if thirds is None:
        thirds = third_poses(frames, motors, np.arange(len(frames)))
    samples = np.concatenate([np.stack([motors[:-1], *thirds], axis=1).reshape(-1, 8), motors[-1:]])
    values = _to_channels(samples, item.rotation_mode, start)
    curves = curves_of(item)
    for column, channel in enumerate(channels_of(item)):
        curve = channel.curve
        if curve is None:
            if np.abs(values[:, column] - channel.value).max() <= SAME:
                continue
            curve = curves.new(channel.path, index=channel.index)
        still = still_once and np.ptp(values[:, column]) <= SINGLE * (1.0 + np.abs(values[0, column]))
        count = 1 if still else len(frames)
        _write_curve(curve, frames[:count], values[: 3 * count - 2, column])


def read_channel_values(item: Item, frames: Floats) -> Floats:
    """Raw numbers (F, 6 or 7) of the channels at frames."""
    return np.array(
        [
            [channel.value if channel.curve is None else channel.curve.evaluate(frame) for channel in channels_of(item)]
            for frame in frames
        ]
    )


def save_keys(item: Item) -> list[tuple[str, int, int, dict[str, NDArray[Any]]]]:
    """The item's location and rotation keys as they are, for ``restore_keys``."""
    saved = []
    for curve in _curves(item):
        points, state = curve.keyframe_points, {}
        for name in STATE:
            pair = name in STATE[:3]
            state[name] = np.zeros(len(points) * (2 if pair else 1), np.float32 if pair else np.int32)
            points.foreach_get(name, state[name])
        saved.append((curve.data_path, curve.array_index, len(points), state))
    return saved


def restore_keys(item: Item, saved: list[tuple[str, int, int, dict[str, NDArray[Any]]]]) -> None:
    """Put back what ``save_keys`` saw; curves that were not there then go."""
    curves = curves_of(item)
    kept = {(path, index) for path, index, _, _ in saved}
    for curve in list(_curves(item)):
        if (curve.data_path, curve.array_index) not in kept:
            curves.remove(curve)
    for path, index, count, state in saved:
        curve = curves.find(path, index=index)
        curve.keyframe_points.clear()
        curve.keyframe_points.add(count)
        for name, values in state.items():
            curve.keyframe_points.foreach_set(name, values)
        curve.update()


def _curves(item: Item) -> Iterator[bpy.types.FCurve]:
    return (channel.curve for channel in channels_of(item) if channel.curve is not None)


def _write_curve(curve: bpy.types.FCurve, frames: Floats, values: Floats) -> None:
    """Keys at frames (K,) from values (3 K - 2,) at the frames and the thirds between."""
    count = len(frames)
    y0, a, b, y1 = values[0:-1:3], values[1::3], values[2::3], values[3::3]
    keys = np.stack([frames, values[::3]], axis=1)
    one_frame = np.array([1.0, 0.0])
    left, right = keys - one_frame, keys + one_frame
    step = np.diff(frames) / 3.0
    right[:-1] = np.stack([frames[:-1] + step, (-5 * y0 + 18 * a - 9 * b + 2 * y1) / 6], axis=1)
    left[1:] = np.stack([frames[1:] - step, (2 * y0 - 9 * a + 18 * b - 5 * y1) / 6], axis=1)
    points = curve.keyframe_points
    points.clear()
    points.add(count)
    for name, pairs in (("co", keys), ("handle_left", left), ("handle_right", right)):
        points.foreach_set(name, pairs.astype(np.float32).ravel())
    for name, number in (("handle_left_type", FREE), ("handle_right_type", FREE), ("interpolation", BEZIER)):
        points.foreach_set(name, np.full(count, number, np.int32))
    curve.update()


def _to_motors(values: Floats, mode: str) -> Floats:
    if mode == "AXIS_ANGLE":
        values = values.copy()
        values[~values[:, 4:7].any(axis=1), 3:7] = (0.0, 1.0, 0.0, 0.0)  # Blender takes no axis for no turn
        return convert(values, "axis_angle", "dual_quaternion")
    if mode != "QUATERNION":
        turns = [Euler(angles, mode).to_quaternion() for angles in values[:, 3:6]]
        values = np.concatenate([values[:, :3], np.array(turns, dtype=np.float64).reshape(-1, 4)], axis=1)
    return convert(values, "quaternion", "dual_quaternion")


def _to_channels(motors: Floats, mode: str, start: Floats) -> Floats:
    """Channel values (F, 6 or 7) without jumps, beginning next to the values ``start``."""
    values = convert(motors, "dual_quaternion", "quaternion")
    if mode == "QUATERNION":
        values[:, 3:] = continuous_signs(values[:, 3:], start[3:7])
        return values
    if mode == "AXIS_ANGLE":
        return _continuous_turns(FORMS["axis_angle"].project(convert(motors, "dual_quaternion", "axis_angle")), start)
    angles, before = [], Euler(start[3:6], mode)
    for quaternion in values[:, 3:]:
        before = Quaternion(quaternion).to_euler(mode, before)
        angles.append(tuple(before))
    return np.concatenate([values[:, :3], np.array(angles)], axis=1)


def _continuous_turns(values: Floats, start: Floats) -> Floats:
    """Axis and angle next to those before: the axis turned over, and whole turns added, where that is nearer."""
    angle, axis = start[3], start[4:7]
    for row in values:
        if row[3] == 0.0:
            row[4:7] = axis if axis.any() else row[4:7]
        if row[4:7] @ axis < 0:
            row[3:7] *= -1.0
        row[3] += 2 * np.pi * np.round((angle - row[3]) / (2 * np.pi))
        angle, axis = row[3], row[4:7]
    return values
