"""The same conversions on tensors: same numbers, exact gradients, finite everywhere."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from unisg_blender.poses import FORMS, PoseError, blend, compose, convert, exp, log, sclerp, split_motor

torch = pytest.importorskip("torch")
NAMES = sorted(FORMS)


def affines(count: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, :3] = rng.normal(size=(count, 3, 4))
    return matrices


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_tensors_give_what_arrays_give(name, dtype):
    form, matrices = FORMS[name], affines(500)
    matrices[3, :3, :3] = 0
    matrices[4, :3, 0] = 0
    matrices[5] = np.eye(4)
    expected = form.encode(matrices, stretch=True)
    features = form.encode(torch.tensor(matrices, dtype=dtype).reshape(5, 100, 4, 4), stretch=True)
    assert features.dtype == dtype
    bound = 1e-4 if dtype == torch.float32 else 1e-11  # rotations of nearly singular blocks are that sensitive
    np.testing.assert_allclose(features.reshape(500, -1).double().numpy(), expected, rtol=0, atol=bound)
    back = form.decode(features, stretch=True).reshape(500, 4, 4).double().numpy()
    assert np.abs(back - matrices).max() < (5e-6 if dtype == torch.float32 else 1e-13)
    raw = np.random.default_rng(1).normal(size=(50, form.width))
    np.testing.assert_allclose(form.project(torch.tensor(raw)).numpy(), form.project(raw), atol=1e-11)
    np.testing.assert_allclose(
        convert(torch.tensor(expected), name, "cga", stretch=True).numpy(),
        convert(expected, name, "cga", stretch=True),
        atol=1e-11,
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_gradients_are_exact(name):
    form = FORMS[name]
    last = torch.tensor([0.0, 0.0, 0.0, 1.0], dtype=torch.float64).expand(2, 1, 4)
    upper = torch.tensor(affines(2)[:, :3]).requires_grad_()
    assert torch.autograd.gradcheck(lambda x: form.encode(torch.cat([x, last], 1), stretch=True), (upper,))
    raw = torch.tensor(np.random.default_rng(7).normal(size=(2, form.width))).requires_grad_()
    assert torch.autograd.gradcheck(form.project, (raw,))
    assert torch.autograd.gradcheck(lambda x: form.decode(form.project(x)), (raw,))
    assert torch.autograd.gradcheck(lambda x: convert(form.project(x), name, "pga_even"), (raw,))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("case", ["identity", "half turn", "flat", "nothing"])
def test_gradients_are_finite_where_formulas_are_singular(name, case):
    linear = {
        "identity": np.eye(3),
        "half turn": np.diag([-1.0, 1.0, -1.0]),
        "flat": np.diag([1.0, 0.0, 0.0]),
        "nothing": np.zeros((3, 3)),
    }[case]
    matrix = np.eye(4)
    matrix[:3, :3] = linear
    leaf = torch.tensor(matrix).requires_grad_()
    features = FORMS[name].encode(leaf, stretch=True)
    (gradient,) = torch.autograd.grad(features.sum(), leaf)
    assert gradient.isfinite().all()
    valid = features.detach().requires_grad_()
    for function in (FORMS[name].decode, FORMS[name].project):
        (gradient,) = torch.autograd.grad(function(valid, stretch=True).sum(), valid)
        assert gradient.isfinite().all()


@pytest.mark.slow
def test_motion_on_tensors():
    motors = FORMS["dual_quaternion"].encode(affines(8))
    tensors = torch.tensor(motors)
    np.testing.assert_allclose(log(tensors).numpy(), log(motors), atol=1e-13)
    np.testing.assert_allclose(compose(tensors, tensors.flip(0)).numpy(), compose(motors, motors[::-1]), atol=1e-13)
    np.testing.assert_allclose(
        sclerp(tensors[0], tensors[1:], 0.3).numpy(), sclerp(motors[0], motors[1:], 0.3), atol=1e-13
    )
    weights = np.random.default_rng(0).random(8)
    np.testing.assert_allclose(blend(tensors, weights).numpy(), blend(motors, weights), atol=1e-13)
    screws = torch.tensor(np.random.default_rng(0).normal(size=(5, 6))).requires_grad_()
    assert torch.autograd.gradcheck(lambda x: log(exp(x)), (screws,))
    assert torch.autograd.gradcheck(lambda x: sclerp(exp(x[0]), exp(x[1:]), 0.4), (screws,))
    (gradient,) = torch.autograd.grad(log(exp(still := torch.zeros(6, requires_grad=True))).sum(), still)
    np.testing.assert_allclose(gradient.numpy(), np.ones(6), atol=1e-6)


def test_parts_of_tensors():
    raw = np.random.default_rng(0).normal(size=(5, 32))
    for found, expected in zip(split_motor(torch.tensor(raw)), split_motor(raw), strict=True):
        np.testing.assert_allclose(found.numpy(), expected, atol=1e-12)


def test_bad_tensors_are_named_by_their_row():
    matrices = torch.eye(4).repeat(3, 1, 1)
    matrices[1, 0, 0] = torch.nan
    with pytest.raises(PoseError, match="row 1"):
        FORMS["pga"].encode(matrices)
    with pytest.raises(PoseError, match="row 2"):
        FORMS["quaternion"].project(torch.cat([torch.ones(2, 7), torch.zeros(1, 7)]))


def test_integers_become_floats():
    assert FORMS["pga"].encode(torch.eye(4, dtype=torch.int64)).dtype == torch.get_default_dtype()


def test_the_room_opens_without_torch_and_clifford():
    script = "import sys, unisg_blender.poses; sys.exit('torch' in sys.modules or 'clifford' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], timeout=60, check=False).returncode == 0
