"""Their axes in ours: points, turns and matrices of other programs as 4x4 matrices, right-handed, z up, metres.

Two frames have y up. In that of glTF, OBJ and Habitat, right-handed, a point (x, y, z) is (x, -z, y) here; in Unity's,
left-handed, it is (x, z, y).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, -1.0, 0], [0, 1.0, 0, 0], [0, 0, 0, 1.0]])
"""From the right-handed frame with y up to ours, (4, 4)."""

UNITY = np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, 1.0, 0, 0], [0, 0, 0, 1.0]])
"""From Unity's left-handed frame to ours, (4, 4); its own inverse."""


LARGEST = 1e12
"""No number of a place, a size or an angle is larger."""


def numbers(values: Any, count: int) -> Array:
    """``count`` finite numbers as an array; ValueError if they are not that."""
    found = np.asarray(values, np.float64).reshape(-1)
    if len(found) != count or not (np.abs(found) < LARGEST).all():
        raise ValueError(f"{count} finite numbers are expected, not {str(values)[:60]!r}")
    return found


def point_rows(values: Any) -> Array:
    """Points (K, 3) out of finite numbers; ValueError if they are not that."""
    found = np.asarray(values, np.float64).reshape(-1, 3)
    if not (np.abs(found) < LARGEST).all():
        raise ValueError("points are not finite")
    return found


def unity_point(record: Mapping[str, float]) -> Array:
    """A point or a size ``{"x", "y", "z"}`` of Unity in our axes, (3,)."""
    found = np.array((record["x"], record["z"], record["y"]), np.float64)
    if not (np.abs(found) < LARGEST).all():
        raise ValueError("a point is not finite")
    return found


def unity_turn(degrees: Mapping[str, float]) -> Array:
    """The rotation (3, 3) of Unity's Euler angles, R = Ry Rx Rz, seen in our axes."""
    swap = UNITY[:3, :3]
    turns = [axis_turn(axis, float(np.radians(degrees[axis]))) for axis in "yxz"]
    return np.asarray(swap @ turns[0] @ turns[1] @ turns[2] @ swap)


def axis_turn(axis: str, angle: float) -> Array:
    """The right-handed rotation (3, 3) by ``angle`` in radians about "x", "y" or "z"."""
    if not np.isfinite(angle):
        raise ValueError("an angle is not finite")
    first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turn, cos, sin = np.eye(3), np.cos(angle), np.sin(angle)
    turn[first, first], turn[second, second], turn[first, second], turn[second, first] = cos, cos, -sin, sin
    return turn


def euler_turn(order: str, angles: Iterable[float]) -> Array:
    """Turns about the axes of ``order`` as a product from left to right, (3, 3): "zxy" is Rz Rx Ry; radians."""
    turn = np.eye(3)
    for axis, angle in zip(order, angles, strict=True):
        turn = turn @ axis_turn(axis, float(angle))
    return turn


def fixed_turn(roll: float, pitch: float, yaw: float) -> Array:
    """Roll, pitch and yaw about the fixed axes x, y, z in radians, as SDF and URDF have them: Rz Ry Rx, (3, 3)."""
    return euler_turn("zyx", (yaw, pitch, roll))


def quaternion_turn(w: float, x: float, y: float, z: float) -> Array:
    """The rotation (3, 3) of a quaternion of any length but 0; ValueError otherwise."""
    found = numbers((w, x, y, z), 4)
    length = float(np.linalg.norm(found))
    if length < 1e-12:
        raise ValueError("a quaternion has no length")
    w, x, y, z = found / length
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def pose(position: Any, turn: Array | None = None, scale: Any = None) -> Array:
    """A matrix (4, 4) that scales, turns and moves."""
    found = np.eye(4)
    if turn is not None:
        found[:3, :3] = turn
    if scale is not None:
        found[:3, :3] = found[:3, :3] * numbers(scale, 3)
    found[:3, 3] = numbers(position, 3)
    return found


def rigid_inverse(matrix: Array) -> Array:
    """The inverse of a matrix that turns and moves; a solver's threads cost a hundred times that."""
    found = np.eye(4)
    found[:3, :3] = matrix[:3, :3].T
    found[:3, 3] = -matrix[:3, :3].T @ matrix[:3, 3]
    return found


def seen_from(change: Array, matrix: Array) -> Array:
    """A matrix of another frame in ours; ``change`` turns or mirrors that frame into ours: change M change^-1."""
    return np.asarray(change @ matrix @ change.T)
