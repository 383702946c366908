"""Gradients of the forms: against finite differences wherever formulas branch, and each row by itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from unisg_blender.poses import FORMS, compose, convert, exp, inverse, log, sclerp

torch = pytest.importorskip("torch")
NAMES = sorted(FORMS)
DQ = FORMS["dual_quaternion"]
TILTED = Rotation.from_rotvec([0.3, -0.7, 0.5]).as_matrix()
OTHER = Rotation.from_rotvec([-1.1, 0.2, 0.9]).as_matrix()
PLACES = {
    "general": np.random.default_rng(0).normal(size=(3, 3)),
    "rotation": TILTED,
    "identity": np.eye(3),
    "half turn about an axis": np.diag([-1.0, 1.0, -1.0]),
    "half turn": 2 * np.outer([0.6, 0.0, 0.8], [0.6, 0.0, 0.8]) - np.eye(3),
    "almost half a turn": Rotation.from_rotvec([0.0, 0.0, 3.1]).as_matrix(),
    "uniform scale": 2.5 * TILTED,
    "small uniform scale": 0.2 * OTHER,
    "sheared": TILTED @ np.diag([0.5, 1.0, 2.0]) @ OTHER,
    "mirrored": TILTED @ np.diag([1.0, -2.0, 0.5]),
    "mirrored rotation": -TILTED,
    "nearly singular": TILTED @ np.diag([1.0, 0.7, 1e-3]) @ OTHER,
    "rank 2": TILTED @ np.diag([1.0, 0.7, 0.0]) @ OTHER,
    "tiny": 1e-150 * TILTED @ np.diag([1.0, 2.0, 3.0]),
    "huge": 1e120 * TILTED @ np.diag([1.0, 2.0, 3.0]),
}
ONE_WAY = {"angle", "ax", "ay", "az"}  # the angle is a norm: without a derivative at the identity

QUICK = {"general", "rotation", "identity", "half turn", "uniform scale"}
"""Places that are tried when the slow tests are left out, too."""

Map = Callable[..., np.ndarray]


def matrix(place: str) -> np.ndarray:
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = PLACES[place], [0.4, -1.5, 2.0]
    return found


def directions(place: str) -> np.ndarray:
    """Ways to change an affine, as large as it is. They keep rank 2: beyond it lie mirrored blocks, and R jumps."""
    found = np.zeros((3, 4, 4))
    found[:, :3] = np.random.default_rng(3).normal(size=(3, 3, 4))
    block = PLACES[place]
    found[:, :3, :3] = block @ found[:, :3, :3] if place == "rank 2" else np.abs(block).max() * found[:, :3, :3]
    return 0.01 * found if place == "nearly singular" else found


def as_near(name: str, features: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The features that say the same with the sign, or the way round, of others near them."""
    channels, features = FORMS[name].channels, features.copy()
    if name == "axis_angle" and features[4:7] @ other[4:7] < 0:
        features[3:7] = [2 * np.pi - features[3], *-features[4:7]]
    if {"w", "1"} & set(channels):
        motor = slice(3 if name == "quaternion" else 0, len(channels))
        features[motor] *= -1.0 if features[motor] @ other[motor] < 0 else 1.0
    return features


def assert_derivative(
    function: Map, at: np.ndarray, ways: np.ndarray, near: Map, kept: list[bool] | None = None
) -> None:
    """Gradients are central differences, extrapolated to the fourth order."""
    base, leaf = function(at), torch.tensor(at, requires_grad=True)
    rows = [torch.autograd.grad(y, leaf, retain_graph=True)[0] for y in function(leaf)]
    for way in ways:
        one, half = (
            (near(function(at + h * way), base) - near(function(at - h * way), base)) / (2 * h) for h in (1e-4, 5e-5)
        )
        expected = (4 * half - one) / 3
        found = torch.stack(rows).numpy().reshape(len(rows), -1) @ way.ravel()
        bound = 1e-8 * max(1.0, np.abs(expected).max())
        np.testing.assert_allclose(found[kept or ...], expected[kept or ...], rtol=0, atol=bound)


def places(*others: str) -> list[Any]:
    """All but some."""
    return [
        pytest.param(place, marks=() if place in QUICK else pytest.mark.slow) for place in PLACES if place not in others
    ]


@pytest.mark.parametrize("place", places())
@pytest.mark.parametrize("name", NAMES)
def test_encode(name, place):
    form = FORMS[name]
    for stretch in (False, True):
        channels = (*form.channels, *["stretch"] * 6 * stretch)
        kept = [channel not in ONE_WAY for channel in channels] if place == "identity" else None
        assert_derivative(
            lambda m, stretch=stretch: form.encode(m, stretch=stretch),
            matrix(place), directions(place), lambda x, other: as_near(name, x, other), kept,
        )  # fmt: skip


@pytest.mark.parametrize("place", places("tiny", "huge"))
@pytest.mark.parametrize("name", NAMES)
def test_decode_and_project(name, place):
    """Also beside the valid features, where a network's output is."""
    form, rng = FORMS[name], np.random.default_rng(4)
    for stretch in (False, True):
        valid = form.encode(matrix(place), stretch=stretch)
        ways = rng.normal(size=(3, len(valid)))
        assert_derivative(
            lambda x, stretch=stretch: form.decode(x, stretch=stretch).reshape(-1), valid, ways, lambda x, _: x
        )
        for features in (valid, valid + 0.1 * rng.normal(size=len(valid))):
            if place != "identity" or name != "axis_angle":
                assert_derivative(
                    lambda x, stretch=stretch: form.project(x, stretch=stretch),
                    features, ways, lambda x, other: as_near(name, x, other),
                )  # fmt: skip


def test_scale_of_a_rotation():
    """A turn times s at s = 1: the stretch grows with s, the quaternion does not."""
    scale = torch.tensor(1.0, dtype=torch.float64, requires_grad=True)
    block = torch.ones(4, 4, dtype=torch.float64)
    block[:3, :3] = scale
    features = FORMS["quaternion"].encode(torch.tensor(matrix("rotation")) * block, stretch=True)
    found = [float(torch.autograd.grad(x, scale, retain_graph=True)[0]) for x in features[3:]]
    np.testing.assert_allclose(found, [0, 0, 0, 0, 1, 1, 1, 0, 0, 0], atol=1e-15)


def test_dilator_at_scale_one():
    form = FORMS["cga_similarity"]
    features = torch.tensor(form.encode(np.eye(4)), requires_grad=True)
    (gradient,) = torch.autograd.grad(form.decode(features)[0, 0], features)
    assert float(gradient[form.channels.index("e45")]) == pytest.approx(-2.0, abs=1e-15)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_second_derivatives_and_forward_mode(name):
    for place in ("general", "rotation", "almost half a turn", "mirrored"):
        last = torch.tensor([[0.0, 0.0, 0.0, 1.0]], dtype=torch.float64)
        upper = torch.tensor(matrix(place)[:3], requires_grad=True)

        def encode(x, last=last):
            return FORMS[name].encode(torch.cat([x, last]), stretch=True)

        assert torch.autograd.gradcheck(encode, (upper,), check_forward_ad=True, fast_mode=True)
        assert torch.autograd.gradgradcheck(encode, (upper,), fast_mode=True)


@pytest.mark.parametrize("name", NAMES)
def test_single_precision(name):
    for place in ("general", "rotation", "half turn", "uniform scale", "mirrored"):
        found = []
        for dtype in (torch.float32, torch.float64):
            leaf = torch.tensor(matrix(place).astype(np.float32), dtype=dtype, requires_grad=True)
            features = FORMS[name].encode(leaf, stretch=True)
            weights = torch.linspace(-1, 1, features.shape[-1], dtype=dtype)
            found.append(torch.autograd.grad((weights * features).sum(), leaf)[0].double().numpy())
        np.testing.assert_allclose(found[0], found[1], rtol=0, atol=1e-5 * np.abs(found[1]).max())


places = st.lists(st.sampled_from([*PLACES, "nothing", "rank 1"]), min_size=2, max_size=5, unique=True)


def batch(names: list[str]) -> np.ndarray:
    found = np.tile(np.eye(4), (len(names), 1, 1))
    flat = {"nothing": np.zeros((3, 3)), "rank 1": np.outer([1.0, 2.0, 2.0], [0.0, 0.6, 0.8])}
    for row, name in zip(found, names, strict=True):
        row[:3, :3], row[:3, 3] = {**PLACES, **flat}[name], [1.0, -2.0, 0.5]
    return found


def with_gradient(function: Map, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    leaf = torch.tensor(rows, requires_grad=True)
    result = function(leaf)
    weights = torch.sin(torch.arange(result[0].numel(), dtype=leaf.dtype) + 1).reshape(result.shape[1:])
    return result.detach().numpy(), torch.autograd.grad((weights * result).sum(), leaf)[0].numpy()


def assert_rows_stand_alone(function: Map, rows: np.ndarray) -> None:
    together, gradients = with_gradient(function, rows)
    arrays = function(rows)
    for i in range(len(rows)):
        alone, gradient = with_gradient(function, rows[i : i + 1])
        np.testing.assert_array_equal(together[i], alone[0])
        np.testing.assert_array_equal(gradients[i], gradient[0])
        np.testing.assert_array_equal(arrays[i], function(rows[i : i + 1])[0])


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=5, deadline=None)
@given(names=places)
def test_rows_know_nothing_of_their_neighbours(name, names):
    form, matrices = FORMS[name], batch(names)
    for stretch in (False, True):
        features = form.encode(matrices, stretch=stretch)
        assert_rows_stand_alone(lambda x, stretch=stretch: form.encode(x, stretch=stretch), matrices)
        assert_rows_stand_alone(lambda x, stretch=stretch: form.decode(x, stretch=stretch), features)
        assert_rows_stand_alone(lambda x, stretch=stretch: convert(x, name, "sixd", stretch=stretch), features)
        raw = form.encode(batch(["general", *(n for n in names if n not in ("tiny", "huge"))]), stretch=stretch)
        raw = raw + 0.1 * np.sin(np.arange(raw.shape[-1]))
        assert_rows_stand_alone(lambda x, stretch=stretch: form.project(x, stretch=stretch), raw)


@settings(max_examples=5, deadline=None)
@given(names=places)
def test_motions_know_nothing_of_their_neighbours(names):
    poses = DQ.encode(batch(names))
    step = exp(torch.tensor([0.3, -0.2, 0.9, 1.0, 2.0, 3.0], dtype=torch.float64))
    for function in (log, inverse):
        assert_rows_stand_alone(function, poses)
    assert_rows_stand_alone(exp, log(poses))
    for motion in (compose, lambda x, y: sclerp(x, y, 0.3)):
        assert_rows_stand_alone(lambda x, f=motion: f(x, step if torch.is_tensor(x) else step.numpy()), poses)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.019, 0.021, 1.0, 3.0])
def test_screws(angle):
    screw = np.array([0.6 * angle, 0.0, 0.8 * angle, 1.0, -2.0, 0.5])
    ways, motor = np.random.default_rng(5).normal(size=(3, 8)), exp(screw)
    assert_derivative(exp, screw, ways[:, :6], lambda x, other: as_near("dual_quaternion", x, other))
    assert_derivative(log, motor, ways, lambda x, _: x)
