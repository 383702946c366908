"""Errors of poses with known answers; symmetry, validity, and what zeros and means cost in a form's own space."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import bootstrap, norm

from tests.metrics.hand_made import box_mesh
from unisg_blender.metrics.pose_errors import (
    decoded,
    folds_of,
    invalidity,
    pose_report,
    r_squared,
    rotation_errors,
    summary,
    translation_errors,
)
from unisg_blender.metrics.seed_statistics import interval
from unisg_blender.poses import FORMS
from unisg_blender.scene import mesh_from_faces


def pose(degrees: tuple[float, float, float] = (0, 0, 0), place: tuple[float, float, float] = (0, 0, 0)) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_euler("xyz", degrees, degrees=True).as_matrix()
    matrix[:3, 3] = place
    return matrix


def random_poses(count: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = Rotation.random(count, random_state=seed).as_matrix()
    poses[:, :3, 3] = rng.normal(size=(count, 3))
    return poses


def test_centimetres_and_degrees() -> None:
    assert translation_errors(pose(place=(0.03, 0, 0.04)), pose()) == pytest.approx(5.0)
    for degrees in (0.0, 1e-6, 35.0, 90.0, 179.9999):
        assert rotation_errors(pose((degrees, 0, 0)), pose()) == pytest.approx(degrees, abs=1e-9)
        assert rotation_errors(pose((0, 0, degrees)), pose()) == pytest.approx(degrees, abs=1e-9)
    assert rotation_errors(pose((0, 0, 180)), pose((0, 0, -180))) == pytest.approx(0, abs=1e-6)
    assert summary(np.arange(101.0)) == {"median": 50, "p95": 95}


def test_what_a_symmetric_thing_does_not_show_is_no_error() -> None:
    for fold, turn, rest in ((1, 90, 90), (2, 170, 10), (4, 100, 10), (4, 45, 45), (0, 77, 0)):
        assert rotation_errors(pose((0, 0, turn)), pose(), np.array(fold)) == pytest.approx(rest, abs=1e-6)
    tilted = pose((0, 0, 90)) @ pose((20, 0, 0))
    assert rotation_errors(tilted, pose(), np.array(4)) == pytest.approx(20, abs=1e-6)
    assert rotation_errors(pose((0, 0, 40)) @ pose((30, 0, 0)), pose(), np.array(0)) == pytest.approx(30, abs=1e-6)


def test_symmetry_aware_angle_is_the_smallest_over_the_group() -> None:
    found, truth = random_poses(50, 1), random_poses(50, 2)
    for fold in (1, 2, 4):
        same = [truth @ pose((0, 0, 360 * k / fold)) for k in range(fold)]
        least = np.min([rotation_errors(found, other) for other in same], axis=0)
        np.testing.assert_allclose(rotation_errors(found, truth, np.full(50, fold)), least, atol=1e-6)


def test_symmetry_of_meshes() -> None:
    ring = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    circle = np.column_stack([np.cos(ring), np.sin(ring), np.zeros(24)])
    assert folds_of(mesh_from_faces("disc", circle, [list(range(24))])) == 0
    assert folds_of(box_mesh(((1, 1, 1), (0, 0, 0)))) == 4
    assert folds_of(box_mesh(((2, 1, 1), (0, 0, 0)))) == 2
    assert folds_of(box_mesh(((1, 1, 1), (0.3, 0, 0)))) == 1


@pytest.mark.parametrize("form", FORMS)
def test_true_features_have_no_error_and_are_valid(form: str) -> None:
    truth = random_poses(40)
    report = pose_report(FORMS[form].encode(truth), truth, form, np.ones(40, int))
    assert max(report.values()) < 1e-5


@pytest.mark.parametrize("form", ["dual_quaternion", "pga", "pga_even", "cga", "cga_even"])
def test_any_multiple_of_a_motor_is_as_valid_and_the_same_pose(form: str) -> None:
    truth = random_poses(10)
    raw = -3.5 * FORMS[form].encode(truth)
    np.testing.assert_allclose(decoded(raw, form), truth, atol=1e-9)
    assert invalidity(raw, form) < 1e-9
    assert invalidity(raw + np.eye(1, raw.shape[1]) * 0.5, form) > 1e-3


def test_rows_of_zeros_are_told_as_wrong_not_as_failure() -> None:
    assert np.isfinite(decoded(np.zeros((3, 16)), "pga")).all()


def test_padding_makes_a_loss_small() -> None:
    """The same poses, all zeros predicted: half the loss in twice the width."""
    truth = random_poses(200)
    cost = {form: float((FORMS[form].encode(truth) ** 2).mean()) for form in FORMS}
    assert cost["pga"] == pytest.approx(cost["dual_quaternion"] / 2)
    assert cost["pga_even"] == pytest.approx(cost["dual_quaternion"])
    assert cost["cga"] < cost["pga"] < cost["dual_quaternion"] < cost["matrix"]


def test_the_mean_explains_nothing_and_the_truth_everything() -> None:
    truth = np.random.default_rng(0).normal(size=(30, 4))
    mean = truth.mean(axis=0)
    assert r_squared(np.broadcast_to(mean, truth.shape), truth, mean) == pytest.approx(0)
    assert r_squared(truth, truth, mean) == 1


def test_intervals_are_students() -> None:
    values = [1.0, 2.0, 3.0, 4.0]
    found = interval(values)
    assert found["mean"] == 2.5
    assert found["half_width"] == pytest.approx(3.182446 * np.std(values, ddof=1) / 2, rel=1e-5)
    assert np.isnan(interval([1.0])["half_width"])
    many = norm.rvs(size=400, random_state=1)
    low, high = bootstrap((many,), np.mean, random_state=1).confidence_interval
    assert interval(many)["half_width"] == pytest.approx((high - low) / 2, rel=0.1)
