"""Screws, interpolation, blending and keyframe reduction."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.linalg import expm
from scipy.spatial.transform import Rotation, Slerp

from unisg_blender.poses import (
    FORMS,
    PoseError,
    blend,
    compose,
    convert,
    cubic_sclerp,
    exp,
    inverse,
    linear_slerp,
    log,
    pose_errors,
    rebuild,
    rebuild_cubic,
    reduce_keyframes,
    sclerp,
    third_poses,
)

DQ = FORMS["dual_quaternion"]
unit = st.floats(-1.0, 1.0, width=32).map(lambda x: x if abs(x) > 1e-6 else 0.0)
screws = arrays(np.float64, 6, elements=unit).map(lambda x: x * [1.8, 1.8, 1.8, 10, 10, 10])  # angles below pi
motors = screws.map(exp)


def twist_matrix(screw) -> np.ndarray:
    x, y, z, *v = screw
    return np.array([[0, -z, y, v[0]], [z, 0, -x, v[1]], [-y, x, 0, v[2]], [0, 0, 0, 0]])


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(screws, st.sampled_from([1.0, 1e-3, 1e-9, 0.0]))
def test_exponential_is_the_matrix_exponential(screw, size):
    screw = screw * size
    np.testing.assert_allclose(DQ.decode(exp(screw)), expm(twist_matrix(screw)), rtol=0, atol=2e-13)
    np.testing.assert_allclose(log(exp(screw)), screw, rtol=1e-12, atol=1e-13 * size)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4, 0.0199, 0.0201, 1.0, np.pi - 1e-7, np.pi])
def test_logarithm_at_every_angle(angle):
    screw = np.array([0, 0, angle, 1.0, 2.0, 3.0])
    np.testing.assert_allclose(log(exp(screw)), screw, rtol=0, atol=1e-14)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(motors, motors)
def test_inverse_undoes(a, b):
    for name in FORMS:
        x, y = convert(a, "dual_quaternion", name), convert(b, "dual_quaternion", name)
        undone = compose(inverse(x, name), compose(x, y, name), name)
        np.testing.assert_allclose(FORMS[name].decode(undone), DQ.decode(b), atol=1e-12)


sizes = st.floats(0.01, 100.0)


def of_class(name: str, rigid: np.ndarray, size: float) -> np.ndarray:
    """The most general affine that a form holds by itself, from a rigid one and a size."""
    if name == "trs_matrix":
        return rigid @ np.array([[size, 0.3, 0, 0], [0, -2.0, 0, 0], [0.5, 0, 0.5, 0], [0, 0, 0, 1]])
    return rigid @ np.diag([size, size, size, 1.0]) if name == "cga_similarity" else rigid


@pytest.mark.parametrize("name", sorted(FORMS))
@settings(max_examples=30, deadline=None)
@given(motors, motors, sizes, sizes)
def test_composition_and_inverse_are_those_of_the_matrices(name, a, b, first, second):
    form = FORMS[name]
    a, b = of_class(name, DQ.decode(a), first), of_class(name, DQ.decode(b), second)
    x, y = form.encode(a), form.encode(b)
    for found, expected in ((compose(x, y, name), a @ b), (inverse(x, name), np.linalg.inv(a))):
        tolerance = 1e-12 * max(1.0, np.abs(expected).max())
        np.testing.assert_allclose(form.decode(found), expected, rtol=0, atol=tolerance)
        np.testing.assert_allclose(found, form.encode(expected), rtol=0, atol=1e-12 * max(1.0, np.abs(found).max()))
        np.testing.assert_allclose(form.project(found), found, rtol=0, atol=1e-12 * max(1.0, np.abs(found).max()))
    single = form.decode(compose(x.astype(np.float32), y.astype(np.float32), name))
    assert single.dtype == np.float32
    assert np.abs(single - a @ b).max() < 1e-5 * max(1.0, np.abs(a).max() * np.abs(b).max())


@pytest.mark.parametrize("name", ["trs_matrix", "cga_similarity"])
def test_a_scale_of_zero_has_no_inverse(name):
    flat = np.tile(np.eye(4), (3, 1, 1))
    flat[1, :3, :3] = 0.0
    features = FORMS[name].encode(flat)
    with pytest.raises(PoseError, match="row 1: the pose has a scale of zero"):
        inverse(features, name)
    np.testing.assert_array_equal(FORMS[name].decode(compose(features, features, name)), flat)


@pytest.mark.parametrize("name", ["trs_matrix", "cga_similarity"])
def test_screws_refuse_scale(name):
    """The forms that hold scale interpolate rigid poses as the others do, and say so where there is more."""
    rng = np.random.default_rng(6)
    poses = exp(rng.normal(size=(3, 6)))
    rigid = convert(poses, "dual_quaternion", name)
    larger = np.array([np.eye(4), np.diag([1.001, 1.001, 1.001, 1.0]), np.eye(4)])
    scaled = FORMS[name].encode(DQ.decode(poses) @ larger)
    calls = {
        "log": lambda x: log(x, name),
        "sclerp": lambda x: sclerp(rigid, x, 0.3, name),
        "cubic": lambda x: cubic_sclerp(rigid, rigid, x, rigid, 0.3, name),
        "line": lambda x: linear_slerp(x, rigid, 0.3, name),
        "blend": lambda x: blend(np.stack([rigid, x], 1), np.ones((3, 2)), name),
        "reduction": lambda x: reduce_keyframes([0, 1, 2], x, 1, 1, name),
    }
    for call in calls.values():
        call(rigid)
        with pytest.raises(PoseError, match=r"row 1.*scale or shear"):
            call(scaled)
    np.testing.assert_allclose(log(rigid, name), log(poses), atol=1e-12)
    np.testing.assert_allclose(log(rigid.astype(np.float32), name), log(poses), atol=1e-5)
    np.testing.assert_allclose(pose_errors(scaled, rigid, name), 0.0, atol=1e-12)  # a measure of the rigid part


@pytest.mark.parametrize("source", sorted(FORMS))
@pytest.mark.parametrize("target", sorted(FORMS))
def test_conversion_drops_what_the_target_does_not_hold(source, target):
    rigid = DQ.decode(exp(np.array([0.2, -0.9, 0.4, 1.0, 2.0, 3.0])))
    similar = of_class("cga_similarity", rigid, 2.5)
    held = {"trs_matrix", "cga_similarity"}
    expected = similar if {source, target} <= held else rigid
    found = convert(FORMS[source].encode(similar), source, target)
    np.testing.assert_allclose(FORMS[target].decode(found), expected, atol=1e-14)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(motors, motors, st.floats(0.0, 1.0))
def test_screw_interpolation_is_the_power_of_the_relative_motion(a, b, fraction):
    np.testing.assert_allclose(DQ.decode(sclerp(a, b, 0.0)), DQ.decode(a), atol=1e-12)
    np.testing.assert_allclose(DQ.decode(sclerp(a, b, 1.0)), DQ.decode(b), atol=1e-12)
    step = log(compose(inverse(a), b))
    if np.linalg.norm(step[:3]) < np.pi - 1e-6:
        expected = DQ.decode(a) @ expm(fraction * twist_matrix(step))
        np.testing.assert_allclose(DQ.decode(sclerp(a, b, fraction)), expected, atol=1e-11)
        np.testing.assert_allclose(sclerp(a, b, fraction), sclerp(b, a, 1.0 - fraction), atol=1e-11)


@settings(max_examples=60, deadline=None)
@given(motors, motors, st.floats(0.0, 1.0))
def test_rotation_of_a_screw_is_slerp(a, b, fraction):
    turns = Rotation.from_matrix(DQ.decode(np.stack([a, b]))[:, :3, :3])
    if (turns[0].inv() * turns[1]).magnitude() < np.pi - 1e-6:
        expected = Slerp([0, 1], turns)(fraction).as_matrix()
        np.testing.assert_allclose(DQ.decode(sclerp(a, b, fraction))[:3, :3], expected, atol=1e-12)


def test_interpolation_does_not_depend_on_the_frame():
    """The screw path moves with the world; linear + slerp does not."""
    rng = np.random.default_rng(0)
    a, b, g = exp(rng.normal(size=(3, 6)))
    np.testing.assert_allclose(sclerp(compose(g, a), compose(g, b), 0.3), compose(g, sclerp(a, b, 0.3)), atol=1e-13)
    np.testing.assert_allclose(sclerp(compose(a, g), compose(b, g), 0.3), compose(sclerp(a, b, 0.3), g), atol=1e-13)


def test_a_door_turns_about_its_hinge():
    shut = np.eye(4)
    shut[:3, 3] = [0.5, 0.0, 0.0]  # the origin half a metre from the hinge
    hinge = np.eye(4)
    hinge[:3, :3] = Rotation.from_euler("z", 170, degrees=True).as_matrix()
    ends = DQ.encode(np.stack([shut, hinge @ shut]))
    path = DQ.decode(sclerp(ends[0], ends[1], np.linspace(0, 1, 50)))
    np.testing.assert_allclose(np.linalg.norm(path[:, :3, 3], axis=1), 0.5, atol=1e-14)


def test_the_long_way_round_on_request():
    for name in ("dual_quaternion", "quaternion", "pga", "cga_even"):
        a = FORMS[name].encode(np.eye(4))
        quarter = np.eye(4)
        quarter[:3, :3] = Rotation.from_euler("x", 90, degrees=True).as_matrix()
        b = FORMS[name].encode(quarter)
        other = np.concatenate([b[:3], -b[3:]]) if name == "quaternion" else -b
        angles = [
            convert(sclerp(a, end, 0.5, name, shortest), name, "axis_angle")[3:5]
            for end, shortest in ((b, True), (other, True), (b, False), (other, False))
        ]
        np.testing.assert_allclose(np.degrees([angle for angle, _ in angles]), [45, 45, 45, 135], atol=1e-10)
        np.testing.assert_allclose([axis for _, axis in angles], [1, 1, 1, -1], atol=1e-14)


def test_half_turns_interpolate():
    half = np.eye(4)
    half[:3, :3] = np.diag([-1.0, -1.0, 1.0])
    angle, *axis = convert(sclerp(DQ.encode(np.eye(4)), DQ.encode(half), 0.5), "dual_quaternion", "axis_angle")[3:]
    assert angle == pytest.approx(np.pi / 2, abs=1e-15)
    np.testing.assert_allclose(axis, [0, 0, 1], atol=1e-15)


def test_many_bodies_and_many_times_broadcast():
    rng = np.random.default_rng(1)
    a, b = exp(rng.normal(size=(2, 5, 6)))
    together = sclerp(a[:, None], b[:, None], np.linspace(0, 1, 7))
    assert together.shape == (5, 7, 8)
    np.testing.assert_array_equal(together[3, 4], sclerp(a[3], b[3], 4 / 6))


@settings(max_examples=60, deadline=None)
@given(motors, screws, st.floats(0.0, 1.0))
def test_blend_is_near_the_screw_for_near_poses(a, screw, fraction):
    b = compose(a, exp(0.1 * screw))
    distance, angle = pose_errors(blend(np.stack([a, b]), [1 - fraction, fraction]), sclerp(a, b, fraction))
    assert distance < 5e-3
    assert angle < 1e-3
    np.testing.assert_allclose(blend(np.stack([a, b]), [0.5, 0.5]), sclerp(a, b, 0.5), atol=1e-12)


def test_blend_of_several_is_valid_and_blind_to_sign():
    rng = np.random.default_rng(2)
    x, weights = exp(rng.normal(size=(4, 3, 6))), rng.random((4, 3))
    blended = blend(x, weights)
    np.testing.assert_allclose(DQ.project(blended), blended, atol=1e-14)
    np.testing.assert_allclose(blend(x * np.array([1, -1, -1])[:, None], 2 * weights), blended, atol=1e-14)
    with pytest.raises(PoseError, match="row 1"):
        blend(x[:, :2], [[1, 1], [0, 0], [1, 1], [1, 1]])


def keyed_motion(bodies: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    keys = np.array([0, 40, 55, 120, 199])
    return np.arange(200) / 24, keys, exp(rng.normal(size=(len(keys), bodies, 6)))


@pytest.mark.parametrize("form", ["dual_quaternion", "pga", "quaternion"])
@pytest.mark.parametrize("shared", [False, True])
def test_reduction_finds_the_keys_a_motion_was_made_of(form, shared):
    times, keys, poses = keyed_motion(6)
    dense = rebuild(times, times[keys], poses)
    found = reduce_keyframes(times, convert(dense, "dual_quaternion", form), 0.01, 0.001, form, shared)
    assert len(found) == (1 if shared else 6)
    for frames in found:
        np.testing.assert_array_equal(frames, keys)


@pytest.mark.parametrize("shared", [False, True])
@pytest.mark.parametrize(("millimetres", "degrees"), [(1.0, 0.1), (10.0, 0.05), (0.2, 5.0)])
def test_reduction_keeps_every_frame_within_tolerance(shared, millimetres, degrees):
    rng = np.random.default_rng(3)
    times = np.cumsum(rng.uniform(0.01, 0.05, 150))
    dense = exp(np.cumsum(np.cumsum(rng.normal(size=(150, 4, 6)), 0), 0) * 2e-5)
    total = 0
    for body, frames in enumerate(reduce_keyframes(times, dense, millimetres, degrees, shared=shared)):
        motion = dense if shared else dense[:, body]
        distance, angle = pose_errors(rebuild(times, times[frames], motion[frames]), motion)
        assert distance.max() <= millimetres * 1e-3
        assert np.degrees(angle).max() <= degrees
        assert frames[0] == 0
        assert frames[-1] == 149
        total += len(frames)
    assert total < 0.7 * 150 * (1 if shared else 4)


@pytest.mark.slow
@pytest.mark.parametrize("form", ["dual_quaternion", "pga"])
@pytest.mark.parametrize("shared", [False, True])
def test_cubic_motors_rebuild_smooth_motions_from_fewer_keys(form, shared):
    rng = np.random.default_rng(4)
    times = np.cumsum(rng.uniform(0.5, 1.5, 200))
    phase = times[:, None, None] / times[-1] * rng.uniform(2, 8, (3, 6)) + rng.uniform(0, 6, (3, 6))
    dense = convert(exp(np.sin(phase)), "dual_quaternion", form)
    screws = reduce_keyframes(times, dense, 1.0, 0.1, form, shared)
    cubics = reduce_keyframes(times, dense, 1.0, 0.1, form, shared, cubic_sclerp)
    for body, (many, few) in enumerate(zip(screws, cubics, strict=True)):
        motion = dense if shared else dense[:, body]
        thirds = third_poses(times, motion, few, form)
        distance, angle = pose_errors(rebuild_cubic(times, times[few], motion[few], thirds, form), motion, form)
        assert distance.max() <= 1e-3
        assert np.degrees(angle.max()) <= 0.1
        assert len(few) < 0.5 * len(many)


@settings(max_examples=40, deadline=None)
@given(motors, screws, st.floats(0.0, 1.0))
def test_cubic_path_goes_through_its_poses_and_holds_screws(a, screw, fraction):
    p, q, b = (compose(a, exp(third * screw)) for third in (1 / 3, 2 / 3, 1.0))
    for place, pose in ((0.0, a), (1 / 3, p), (2 / 3, q), (1.0, b)):
        np.testing.assert_allclose(DQ.decode(cubic_sclerp(a, p, q, b, place)), DQ.decode(pose), atol=1e-11)
    if np.linalg.norm(screw[:3]) < np.pi - 1e-6:
        found = DQ.decode(cubic_sclerp(a, p, q, b, fraction))
        np.testing.assert_allclose(found, DQ.decode(sclerp(a, b, fraction)), atol=1e-11)


@settings(max_examples=40, deadline=None)
@given(motors, motors, st.floats(0.0, 1.0))
def test_linear_slerp_is_a_line_and_a_slerp(a, b, fraction):
    found, ends = DQ.decode(linear_slerp(a, b, fraction)), DQ.decode(np.stack([a, b]))
    np.testing.assert_allclose(found[:3, 3], ends[0, :3, 3] * (1 - fraction) + ends[1, :3, 3] * fraction, atol=1e-12)
    np.testing.assert_allclose(found[:3, :3], DQ.decode(sclerp(a, b, fraction))[:3, :3], atol=1e-12)


def test_small_motions_reduce():
    one = np.tile(exp(np.zeros(6)), (1, 1))
    np.testing.assert_array_equal(reduce_keyframes([0.0], one, 1, 1)[0], [0])
    still = np.tile(one, (90, 1))
    np.testing.assert_array_equal(reduce_keyframes(np.arange(90), still, 1e-6, 1e-6)[0], [0, 89])
    assert reduce_keyframes(np.arange(90), np.zeros((90, 0, 8)), 1, 1) == []
    np.testing.assert_array_equal(rebuild([-1.0, 5.0], [0.0], one), np.tile(one, (2, 1)))


@pytest.mark.parametrize(
    ("times", "poses", "tolerance", "words"),
    [
        ([0, 1, 1], (3, 8), 1.0, "rise"),
        ([0, 1], (3, 8), 1.0, "one time per frame"),
        ([0, 1, 2], (3, 8), 0.0, "positive"),
        ([0, 1, 2], (3, 7), 1.0, "8"),
        ([], (0, 8), 1.0, "frames"),
    ],
)
def test_reduction_refuses_what_it_cannot_use(times, poses, tolerance, words):
    with pytest.raises(PoseError, match=words):
        reduce_keyframes(times, np.ones(poses), tolerance, tolerance)
