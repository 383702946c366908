"""Turns and points of other programs, beside scipy's rotations."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from unisg_blender.formats import axes

ANGLES = st.floats(-7, 7)


@given(ANGLES, ANGLES, ANGLES)
def test_turns_are_scipys(one: float, two: float, three: float) -> None:
    for axis in "xyz":
        np.testing.assert_allclose(axes.axis_turn(axis, one), Rotation.from_euler(axis, one).as_matrix(), atol=1e-12)
    for order in ("zxy", "xyz", "zyx"):
        expected = Rotation.from_euler(order.upper(), (one, two, three)).as_matrix()
        np.testing.assert_allclose(axes.euler_turn(order, (one, two, three)), expected, atol=1e-12)
    expected = Rotation.from_euler("xyz", (one, two, three)).as_matrix()
    np.testing.assert_allclose(axes.fixed_turn(one, two, three), expected, atol=1e-12)


@given(st.lists(st.floats(-3, 3), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 1e-3))
def test_quaternions_of_any_length_are_scipys(wxyz: list[float]) -> None:
    expected = Rotation.from_quat(np.roll(wxyz, -1)).as_matrix()
    np.testing.assert_allclose(axes.quaternion_turn(*wxyz), expected, atol=1e-9)


@given(ANGLES, ANGLES, ANGLES)
def test_unitys_turns_are_mirrored_ones(x: float, y: float, z: float) -> None:
    """Ry Rx Rz of a left-handed frame: there every turn goes the other way about its axis."""
    found = axes.unity_turn({"x": np.degrees(x), "y": np.degrees(y), "z": np.degrees(z)})
    mirrored = Rotation.from_euler("ZXY", (-y, -x, -z)).as_matrix()  # their y is our z, their z our y
    np.testing.assert_allclose(found, mirrored, atol=1e-12)


def test_points_and_frames() -> None:
    assert axes.unity_point({"x": 1, "y": 2, "z": 3}).tolist() == [1, 3, 2]
    np.testing.assert_array_equal(axes.Y_UP @ [1, 2, 3, 1], [1, -3, 2, 1])
    assert np.linalg.det(axes.Y_UP) == 1
    assert np.linalg.det(axes.UNITY) == -1
    turn = np.eye(4)
    turn[:3, :3] = axes.axis_turn("y", 0.3)
    np.testing.assert_allclose(axes.seen_from(axes.Y_UP, turn)[:3, :3], axes.axis_turn("z", 0.3))


def test_poses_scale_then_turn_then_move() -> None:
    turn = axes.fixed_turn(0.1, -0.7, 2.0)
    found = axes.pose((1, 2, 3), turn, (2, 3, 4))
    point = np.array([0.5, -1, 2])
    np.testing.assert_allclose(found @ [*point, 1], [*(turn @ (point * (2, 3, 4)) + (1, 2, 3)), 1])
    np.testing.assert_array_equal(axes.pose((1, 2, 3))[:3], [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3]])
    rigid = axes.pose((1, 2, 3), turn)
    np.testing.assert_allclose(axes.rigid_inverse(rigid) @ rigid, np.eye(4), atol=1e-12)


@pytest.mark.parametrize(
    "call",
    [
        lambda: axes.numbers([1, 2], 3), lambda: axes.numbers([1, np.nan], 2), lambda: axes.numbers([1, 1e12], 2),
        lambda: axes.numbers([-1e13, 1], 2), lambda: axes.point_rows([0, 0, np.inf]), lambda: axes.point_rows([0, 0]),
        lambda: axes.unity_point({"x": 0, "y": np.nan, "z": 0}), lambda: axes.axis_turn("x", np.inf),
        lambda: axes.quaternion_turn(0, 0, 0, 0),
    ],
)  # fmt: skip
def test_what_is_no_number_is_refused(call) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ValueError, match=r"\w"):
        call()


def test_what_is_a_number_is_taken() -> None:
    assert axes.numbers([[1], [-9e11]], 2).tolist() == [1, -9e11]
    assert axes.point_rows([[0, 1, 2], [3, 4, 5]]).shape == (2, 3)
