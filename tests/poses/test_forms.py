"""Round trips, equivalences and edge cases of the representation forms."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from unisg_blender import UniSGError
from unisg_blender.poses import FORMS, STRETCH_CHANNELS, STRETCH_WIDTH, PoseError, convert

NAMES = sorted(FORMS)
MOTORS = ["dual_quaternion", "pga", "pga_even", "cga", "cga_even", "cga_similarity"]
WIDTHS = {
    **{"matrix": 16, "trs_matrix": 16, "axis_angle": 7, "quaternion": 7, "sixd": 9, "dual_quaternion": 8},
    **{"pga": 16, "pga_even": 8, "cga": 32, "cga_even": 16, "cga_similarity": 32},
}
S = np.sqrt(0.5)
AXES = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [S, S, 0], [-S, 0, S], [0.6, -0.64, 0.48]])
ANGLES = [0.0, 1e-9, 1e-4, 0.5, np.pi / 2, np.pi - 1e-7, np.pi, np.pi + 1e-7, 2 * np.pi - 1e-9, 2 * np.pi]

finite = st.floats(-1.0, 1.0, width=32).map(lambda x: x if abs(x) > 1e-6 else 0.0)  # no underflow when halved
quaternions = arrays(np.float64, 4, elements=finite).filter(lambda q: np.linalg.norm(q) > 1e-3)
translations = st.tuples(arrays(np.float64, 3, elements=finite), st.sampled_from([0.0, 1e-6, 1.0, 1e6])).map(
    lambda pair: pair[0] * pair[1]
)
scales = arrays(np.float64, 3, elements=st.sampled_from([-2.0, -1.0, 0.0, 1e-6, 0.1, 1.0, 3.0, 1e3]))


def pose(linear, translation=(0, 0, 0)) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, translation
    return matrix


def rotation(quaternion) -> np.ndarray:
    return Rotation.from_quat(np.roll(quaternion, -1)).as_matrix()


def turn(axis, angle) -> np.ndarray:
    """Rodrigues' formula, exact where sine and cosine are (scipy's detour over quaternions is not)."""
    x, y, z = axis
    cosine, sine = (-1.0, 0.0) if angle == np.pi else (np.cos(angle), np.sin(angle))
    hat = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sine * hat + (1 - cosine) * (np.outer(axis, axis) / np.dot(axis, axis) - np.eye(3))


rigid = st.builds(lambda q, t: pose(rotation(q), t), quaternions, translations)
affine = st.builds(
    lambda q, s, p, t: pose(rotation(q) @ np.diag(s) @ rotation(p), t), quaternions, scales, quaternions, translations
)


def worst(result: np.ndarray, expected: np.ndarray) -> float:
    """Largest error relative to the norm of the linear block and of the translation, each apart."""
    error = np.abs(np.asarray(result, dtype=np.float64) - expected)
    linear = np.linalg.norm(expected[..., :3, :3], axis=(-2, -1))
    translation = np.linalg.norm(expected[..., :3, 3], axis=-1)
    ratios = [
        error[..., :3, :3].max((-2, -1)) / np.where(linear > 0, linear, 1),
        error[..., :3, 3].max(-1) / np.where(translation > 0, translation, 1),
    ]
    assert (error[..., 3, :] == 0).all()
    return float(np.max(ratios))


def motor_sign_is_canonical(quaternion: np.ndarray) -> bool:
    leading = quaternion[np.flatnonzero(quaternion)[0]]
    return bool(leading > 0)


@pytest.mark.parametrize("name", NAMES)
def test_widths_and_channels(name):
    form = FORMS[name]
    assert form.name == name
    assert form.width == WIDTHS[name] == len(set(form.channels))
    assert len(STRETCH_CHANNELS) == STRETCH_WIDTH == 6


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=30, deadline=None)
@given(rigid)
def test_rigid_round_trip(name, matrix):
    form = FORMS[name]
    features = form.encode(matrix)
    assert worst(form.decode(features), matrix) < 1e-12
    np.testing.assert_allclose(form.project(features), features, rtol=0, atol=1e-14 * np.abs(features).max())


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=50, deadline=None)
@given(affine)
def test_affine_round_trip_with_stretch(name, matrix):
    form = FORMS[name]
    features = form.encode(matrix, stretch=True)
    assert features.shape == (form.width + STRETCH_WIDTH,)
    assert worst(form.decode(features, stretch=True), matrix) < 1e-12
    single = form.encode(matrix.astype(np.float32), stretch=True)
    assert single.dtype == np.float32
    assert worst(form.decode(single, stretch=True), matrix.astype(np.float32).astype(np.float64)) < 1e-6


@pytest.mark.parametrize(("source", "target"), list(itertools.permutations(NAMES, 2)))
def test_every_form_to_every_other(source, target):
    rng = np.random.default_rng(5)
    matrices = np.stack([pose(rotation(rng.normal(size=4)), rng.normal(size=3)) for _ in range(20)])
    converted = convert(FORMS[source].encode(matrices), source, target)
    np.testing.assert_allclose(converted, FORMS[target].encode(matrices), rtol=0, atol=1e-14)
    mirrored = matrices.copy()
    mirrored[:, :3, :3] *= np.array([1, -2, 0.5])
    converted = convert(FORMS[source].encode(mirrored, stretch=True), source, target, stretch=True)
    np.testing.assert_allclose(converted, FORMS[target].encode(mirrored, stretch=True), rtol=0, atol=1e-13)


@settings(max_examples=100, deadline=None)
@given(rigid)
def test_quaternion_agrees_with_scipy(matrix):
    w, x, y, z = FORMS["quaternion"].encode(matrix)[3:]
    np.testing.assert_allclose(Rotation.from_quat([x, y, z, w]).as_matrix(), matrix[:3, :3], rtol=0, atol=2e-15)
    angle, *axis = FORMS["axis_angle"].encode(matrix)[3:]
    np.testing.assert_allclose(Rotation.from_rotvec(angle * np.array(axis)).as_matrix(), matrix[:3, :3], atol=2e-15)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("axis", AXES)
def test_special_angles(name, axis, angle):
    matrix = pose(turn(axis, angle), (1.0, -2.0, 3.0))
    features = FORMS[name].encode(matrix)
    assert worst(FORMS[name].decode(features), matrix) < 1e-12
    w, *v = convert(features, name, "quaternion")[3:]
    expected = min(angle, 2 * np.pi - angle)
    assert 2 * np.arctan2(np.linalg.norm(v), w) == pytest.approx(expected, rel=1e-6, abs=1e-15)


@pytest.mark.parametrize("axis", AXES)
def test_angle_and_axis_at_the_ends(axis):
    form = FORMS["axis_angle"]
    np.testing.assert_array_equal(form.encode(np.eye(4)), [0, 0, 0, 0, 1, 0, 0])
    angle, *found = form.encode(pose(turn(axis, np.pi)))[3:]
    assert angle == np.pi
    np.testing.assert_allclose(found, axis if motor_sign_is_canonical(axis) else -axis, atol=1e-15)
    angle, *found = form.encode(pose(turn(axis, 1e-9)))[3:]
    assert angle == pytest.approx(1e-9, rel=1e-6)
    np.testing.assert_allclose(found, axis, atol=1e-6)


@settings(max_examples=100, deadline=None)
@given(quaternions, translations)
def test_both_signs_of_a_quaternion_are_one_pose(quaternion, translation):
    for q in (quaternion, np.where(np.arange(4) == 0, 0.0, quaternion)):
        if np.linalg.norm(q) < 1e-3:
            continue
        features = FORMS["quaternion"].project(np.array([[*translation, *q], [*translation, *-q]]))
        np.testing.assert_array_equal(features[0], features[1])
        assert motor_sign_is_canonical(features[0, 3:])


@pytest.mark.parametrize("name", MOTORS)
@pytest.mark.parametrize("factor", [1e-3, -1.0, 1e3, -1e-9])
def test_a_motor_times_a_number_is_the_same_motor(name, factor):
    rng = np.random.default_rng(2)
    form = FORMS[name]
    raw = rng.normal(size=(200, form.width))
    np.testing.assert_allclose(form.project(factor * raw), form.project(raw), rtol=1e-10, atol=1e-10)
    matrices = np.stack([pose(rotation(rng.normal(size=4)), rng.normal(size=3)) for _ in range(50)])
    features = factor * form.encode(matrices)
    assert worst(form.decode(form.project(features)), matrices) < 1e-12
    if name != "cga_similarity":
        assert worst(form.decode(features), matrices) < 1e-12


@pytest.mark.parametrize("name", NAMES)
def test_project_makes_valid_features(name):
    form = FORMS[name]
    features = form.project(np.random.default_rng(1).normal(size=(500, form.width)))
    np.testing.assert_allclose(form.project(features), features, rtol=0, atol=1e-10)
    matrices = form.decode(features)
    if name == "trs_matrix":
        return
    linear = matrices[:, :3, :3]
    scale = np.cbrt(np.linalg.det(linear))[:, None, None]
    assert (scale > 0).all()
    gram = np.swapaxes(linear, 1, 2) @ linear / scale**2
    np.testing.assert_allclose(gram, np.tile(np.eye(3), (500, 1, 1)), atol=1e-12)
    np.testing.assert_allclose(form.encode(matrices), features, rtol=1e-9, atol=1e-9)


def test_projected_matrix_is_the_nearest_rotation():
    raw = np.random.default_rng(3).normal(size=(100, 4, 4))
    found = FORMS["matrix"].project(raw.reshape(100, 16)).reshape(100, 4, 4)[:, :3, :3]
    u, _, vt = np.linalg.svd(raw[:, :3, :3])
    u[:, :, 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
    np.testing.assert_allclose(found, u @ vt, atol=1e-12)


def test_motor_slots_stand_where_the_design_says():
    matrix = pose(rotation([0.5, 0.1, -0.7, 0.3]), (1.0, 2.0, 3.0))
    w, x, y, z, dw, dx, dy, dz = FORMS["dual_quaternion"].encode(matrix)
    pga = FORMS["pga"].encode(matrix)
    np.testing.assert_array_equal(np.flatnonzero(pga), [0, 5, 6, 7, 8, 9, 10, 15])
    np.testing.assert_array_equal(pga[[0, 5, 6, 7, 8, 9, 10, 15]], [w, -dx, -dy, -dz, -z, y, -x, -dw])
    cga = FORMS["cga"].encode(matrix)
    slots = [0, 6, 7, 8, 9, 10, 11, 12, 13, 14, 26, 27]
    np.testing.assert_array_equal(np.flatnonzero(cga), slots)
    np.testing.assert_array_equal(cga[slots], [w, -z, y, -dx, -dx, -x, -dy, -dy, -dz, -dz, -dw, -dw])


def test_positive_scale_never_leaks_into_the_rotation():
    for scale in (1e-6, 0.1, 1.0, 1e3):
        for stretch in ((1, 1, 1), (1, 2, 3), (1e-3, 1, 5)):
            linear = turn([0, 0, 1], np.pi / 2) @ np.diag(stretch) * scale
            angle = FORMS["axis_angle"].encode(pose(linear))[3]
            assert angle == pytest.approx(np.pi / 2, abs=1e-14)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "scale",
    [
        *([1e-6] * 3, [1, 1e-6, 1], [-1, 1, 1], [1, -1, -1], [-1, -1, -1], [2, 3, -0.5]),
        *([0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 2, 3], [0, -2, 3], [0, -2, -3], [1e-200] * 3, [1e150, 1, 1e-20]),
    ],
)
def test_scale_of_every_kind_comes_back(name, scale):
    form = FORMS[name]
    for turned in (np.eye(3), turn(AXES[5], 2.0), turn(AXES[3], np.pi)):
        matrix = pose(turned @ np.diag(scale), (4.0, 5.0, -6.0))
        assert worst(form.decode(form.encode(matrix, stretch=True), stretch=True), matrix) < 1e-12


def test_shear_of_a_rotated_child_comes_back():
    parent = pose(np.diag([1.0, 4.0, 0.2]))
    child = parent @ pose(turn([0, 0, 1], np.pi / 4), (1.0, 0.0, 0.0))
    assert not np.allclose(child[:3, :3].T @ child[:3, :3], np.diag(np.diag(child[:3, :3].T @ child[:3, :3])))
    for form in FORMS.values():
        assert worst(form.decode(form.encode(child, stretch=True), stretch=True), child) < 1e-12


def test_mirrored_and_flat_blocks_follow_the_stated_rule():
    def parts(linear):
        features = FORMS["quaternion"].encode(pose(linear), stretch=True)
        return FORMS["quaternion"].decode(features[:7])[:3, :3], features[7:]

    rotated, stretch = parts(np.diag([-1.0, 1.0, 1.0]))  # R = -Q, S = -P
    np.testing.assert_allclose(rotated, np.diag([1, -1, -1]), atol=1e-15)
    np.testing.assert_allclose(stretch, [-1, -1, -1, 0, 0, 0], atol=1e-15)
    quarter = turn([0, 0, 1], np.pi / 2)
    rotated, stretch = parts(quarter @ np.diag([2.0, 3.0, 0.0]))  # rank 2: the plane tells all
    np.testing.assert_allclose(rotated, quarter, atol=1e-15)
    np.testing.assert_allclose(stretch, [2, 3, 0, 0, 0, 0], atol=1e-15)
    rotated, _ = parts(np.outer([0, 1, 0], [1, 0, 0]))  # rank 1: the smallest turn from x to y
    np.testing.assert_allclose(rotated, quarter, atol=1e-15)
    rotated, stretch = parts(np.outer([-1, 0, 0], [1, 0, 0]))  # rank 1 reversed: a half turn, stretch positive
    assert np.trace(rotated) == pytest.approx(-1)
    np.testing.assert_allclose(stretch, [1, 0, 0, 0, 0, 0], atol=1e-15)
    rotated, stretch = parts(np.zeros((3, 3)))
    np.testing.assert_array_equal(rotated, np.eye(3))
    np.testing.assert_array_equal(stretch, np.zeros(6))


@settings(max_examples=200, deadline=None)
@given(affine)
def test_stretch_is_the_polar_factor(matrix):
    features = FORMS["sixd"].encode(matrix, stretch=True)
    xx, yy, zz, xy, xz, yz = features[9:]
    values = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    slack = 1e-12 * max(1.0, np.abs(values).max())
    assert (values > -slack).all() or (values < slack).all()
    expected = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    np.testing.assert_allclose(np.sort(np.abs(values))[::-1], expected, rtol=0, atol=slack)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_not_a_number_is_named_by_its_row(name, value):
    form = FORMS[name]
    matrices = np.tile(np.eye(4), (7000, 1, 1))
    matrices[6543, 1, 2] = value
    with pytest.raises(PoseError, match="row 6543"):
        form.encode(matrices)
    features = form.encode(np.tile(np.eye(4), (4, 5, 1, 1)), stretch=True)
    features[2, 3, -1] = value
    for function in (form.decode, form.project, lambda x, stretch: convert(x, name, "pga", stretch)):
        with pytest.raises(PoseError, match="row 2, 3"):
            function(features, stretch=True)


@pytest.mark.parametrize("name", [n for n in NAMES if n != "trs_matrix"])
def test_features_without_a_pose_are_named(name):
    form = FORMS[name]
    features = form.encode(np.tile(np.eye(4), (3, 1, 1)))
    features[1] = 0.0
    with pytest.raises(ValueError, match="row 1"):
        form.project(features)
    if name != "matrix":
        with pytest.raises(ValueError, match="row 1"):
            form.decode(features)


def test_parallel_columns_hold_no_rotation():
    features = [[0, 0, 0, 1, 2, 3, 2, 4, 6.0]]
    with pytest.raises(PoseError, match="row 0"):
        FORMS["sixd"].project(features)


def test_wrong_inputs_are_told_plainly():
    assert issubclass(PoseError, UniSGError)
    projective = np.eye(4)
    projective[3, 0] = 0.5
    with pytest.raises(PoseError, match="last row"):
        FORMS["pga"].encode(projective)
    with pytest.raises(PoseError, match=r"\(\.\.\., 4, 4\), not \(3, 3\)"):
        FORMS["pga"].encode(np.eye(3))
    with pytest.raises(PoseError, match=r"\(\.\.\., 22\)"):
        FORMS["pga"].decode(np.zeros(16), stretch=True)
    with pytest.raises(PoseError, match="real numbers"):
        FORMS["pga"].encode(np.eye(4) * 1j)
    with pytest.raises(PoseError, match="shape"):
        FORMS["pga"].encode([[1, 2], [3]])


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("leading", [(0,), (3, 0), (1,), (2, 3, 4), ()])
def test_leading_axes_and_empty_batches(name, leading):
    form = FORMS[name]
    matrices = np.broadcast_to(np.eye(4), (*leading, 4, 4))
    for stretch in (False, True):
        features = form.encode(matrices, stretch=stretch)
        assert features.shape == (*leading, form.width + STRETCH_WIDTH * stretch)
        assert form.decode(features, stretch=stretch).shape == (*leading, 4, 4)
        assert form.project(features, stretch=stretch).shape == features.shape
        assert convert(features, name, "cga", stretch=stretch).shape == (*leading, 32 + STRETCH_WIDTH * stretch)


@pytest.mark.parametrize("name", NAMES)
def test_memory_layouts(name):
    rng = np.random.default_rng(0)
    form = FORMS[name]
    matrices = np.stack([pose(rng.normal(size=(3, 3)), rng.normal(size=3)) for _ in range(12)])
    expected = form.encode(matrices, stretch=True)
    frozen = matrices.copy()
    frozen.flags.writeable = False
    strided = np.repeat(matrices, 2, axis=0)[::2]
    columns = np.ascontiguousarray(matrices.transpose(0, 2, 1)).transpose(0, 2, 1)
    for variant in (frozen, strided, columns, matrices.astype(">f8"), np.asfortranarray(matrices), matrices.tolist()):
        found = form.encode(variant, stretch=True)
        np.testing.assert_array_equal(found, expected)
        assert found.dtype == np.float64
        assert found.dtype.isnative
    np.testing.assert_array_equal(form.encode(matrices[::-1], stretch=True), expected[::-1])
    single = form.encode(matrices.astype(np.float32), stretch=True)
    swapped = form.encode(matrices.astype(">f4"), stretch=True)
    assert swapped.dtype == np.float32
    np.testing.assert_array_equal(single, swapped)
    np.testing.assert_array_equal(frozen, matrices)
    assert form.encode(np.eye(4, dtype=int)).dtype == np.float64


def test_blocks_do_not_show():
    """A batch longer than a block gives what its rows give alone."""
    rng = np.random.default_rng(9)
    linear = rng.normal(size=(13_000, 3, 3))
    linear[::7] = np.linalg.qr(linear[::7])[0]
    linear[::11, :, 2] = 0
    matrices = np.tile(np.eye(4), (len(linear), 1, 1))
    matrices[:, :3, :3] = linear
    together = FORMS["cga_similarity"].encode(matrices, stretch=True)
    for row in (0, 7, 11, 77, 5999, 6000, 6001, 12_999):
        np.testing.assert_allclose(
            FORMS["cga_similarity"].encode(matrices[row], stretch=True), together[row], atol=1e-13
        )


@settings(max_examples=60, deadline=None)
@given(st.floats(1e-6, 1e6), quaternions, translations)
def test_the_dilator_carries_uniform_scale(scale, quaternion, translation):
    matrix = pose(scale * rotation(quaternion), translation)
    assert worst(FORMS["cga_similarity"].decode(FORMS["cga_similarity"].encode(matrix)), matrix) < 1e-12
