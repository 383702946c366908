"""The forms under what torch does to functions: ``vmap``, ``jit.trace``, ``compile`` and ``torch.func`` gradients."""

from __future__ import annotations

import io
import warnings

import numpy as np
import pytest

from unisg_blender.poses import FORMS, blend, compose, convert, cubic_sclerp, exp, inverse, linear_slerp, log, sclerp

torch = pytest.importorskip("torch")

pytestmark = pytest.mark.slow  # torch compiles
NAMES = sorted(FORMS)
DTYPES = [torch.float32, torch.float64]


def after(x):
    """Another pose, some way on."""
    return compose(x, exp(torch.tensor([0.3, -0.2, 0.9, 1.0, 2.0, 3.0], dtype=torch.float64)))


MOTIONS = {
    "log": log,
    "exp": lambda x: exp(x[..., :6]),
    "inverse": inverse,
    "compose": after,
    "sclerp": lambda x: sclerp(x, after(x), 0.3),
    "cubic_sclerp": lambda x: cubic_sclerp(x, x, after(x), x, 0.3),
    "linear_slerp": lambda x: linear_slerp(x, after(x), 0.3),
    "blend": lambda x: blend(torch.stack([x, after(x)], -2), torch.full_like(x[..., :2], 0.5)),
    "inverse with scale": lambda x: inverse(convert(x, "dual_quaternion", "cga_similarity"), "cga_similarity"),
}


def affines(dtype) -> torch.Tensor:
    """Every branch of the polar rotation: rotations, general, mirrored, of rank 2, 1 and 0."""
    found = torch.eye(4, dtype=torch.float64).repeat(7, 1, 1)
    found[1:4, :3] = torch.tensor(np.random.default_rng(0).normal(size=(3, 3, 4)))
    found[2, :3, 0] *= -torch.sign(torch.linalg.det(found[2, :3, :3]))
    found[3, :3, 2] = 0.0
    found[4, :3, :3] = torch.outer(torch.arange(3.0), torch.ones(3))
    found[5, :3, :3] = 0.0
    found[6, :3, :3] = torch.diag(torch.tensor([-1.0, 1.0, -1.0]))
    return found.to(dtype)


def functions(name: str):
    form = FORMS[name]
    return (
        lambda x: form.encode(x, stretch=True),
        lambda x: form.decode(form.encode(x, stretch=True), stretch=True),
        lambda x: form.project(form.encode(x) + 0.01),
    )


@pytest.fixture(autouse=True)
def fresh():
    yield
    torch._dynamo.reset()


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", NAMES)
def test_vmap(name, dtype):
    matrices = affines(dtype)
    for function in functions(name):
        torch.testing.assert_close(torch.func.vmap(function)(matrices), function(matrices), rtol=0, atol=0)
    encode = functions(name)[0]
    torch.testing.assert_close(torch.func.vmap(encode, in_dims=2)(matrices.movedim(0, 2)), encode(matrices))
    twice = torch.func.vmap(torch.func.vmap(encode))(matrices[None])
    torch.testing.assert_close(twice[0], encode(matrices), rtol=0, atol=0)


@pytest.mark.parametrize("name", NAMES)
def test_jacobians(name):
    """Row by row, backwards and forwards, they are the blocks of the jacobian of the batch."""
    matrices, encode = affines(torch.float64), functions(name)[0]
    whole = torch.autograd.functional.jacobian(encode, matrices)
    blocks = torch.stack([whole[i, :, i] for i in range(len(matrices))])
    for jacobian in (torch.func.jacrev, torch.func.jacfwd):
        torch.testing.assert_close(torch.func.vmap(jacobian(encode))(matrices), blocks, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", NAMES)
def test_trace(name, dtype):
    """A trace serves other batch sizes, has gradients, and can be saved."""
    matrices = affines(dtype)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for function in functions(name):
            traced = torch.jit.trace(function, (matrices[:2],))
            torch.testing.assert_close(traced(matrices), function(matrices))
        traced = torch.jit.trace(functions(name)[0], (matrices[:2],))
        file = io.BytesIO()
        torch.jit.save(traced, file)
        file.seek(0)
        traced = torch.jit.load(file)
    gradients = []
    for function in (traced, functions(name)[0]):
        leaf = matrices.clone().requires_grad_()
        gradients.append(torch.autograd.grad(function(leaf)[:3].sum(), leaf)[0])
    torch.testing.assert_close(*gradients)


@pytest.mark.parametrize("name", NAMES)
def test_compile_in_one_graph(name):
    matrices = affines(torch.float64)
    for function in functions(name):
        compiled = torch.compile(function, fullgraph=True, backend="eager")
        torch.testing.assert_close(compiled(matrices), function(matrices), rtol=1e-12, atol=1e-12)
        torch._dynamo.reset()


def test_gradients_of_what_is_compiled():
    """``aot_eager`` is all of the compiler but the machine code."""
    results = []
    for run in (encode := functions("quaternion")[0], torch.compile(encode, fullgraph=True, backend="aot_eager")):
        leaf = affines(torch.float64).requires_grad_()
        results.append(torch.autograd.grad(run(leaf)[:3].sum(), leaf)[0])
    torch.testing.assert_close(*results, rtol=1e-12, atol=1e-12)


@pytest.mark.slow
def test_compile_to_machine_code():
    encode = functions("cga_similarity")[0]
    for dtype in DTYPES:
        matrices = affines(dtype)
        torch.testing.assert_close(torch.compile(encode, fullgraph=True)(matrices), encode(matrices))


@pytest.mark.parametrize("name", MOTIONS)
def test_motions(name):
    motion, motors = MOTIONS[name], FORMS["dual_quaternion"].encode(affines(torch.float64))
    torch.testing.assert_close(torch.func.vmap(motion)(motors), motion(motors), rtol=0, atol=1e-15)
    compiled = torch.compile(motion, fullgraph=True, backend="eager")
    torch.testing.assert_close(compiled(motors), motion(motors), rtol=0, atol=1e-14)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        torch.testing.assert_close(torch.jit.trace(motion, (motors,))(motors), motion(motors), rtol=0, atol=1e-14)


@pytest.mark.parametrize("name", [name for name in NAMES if name != "trs_matrix"])
def test_rows_without_a_pose_are_not_a_number_where_nothing_can_be_raised(name):
    features = FORMS[name].encode(torch.eye(4).repeat(2, 1, 1))
    features[1] = 0.0
    found = torch.func.vmap(FORMS[name].project)(features)
    assert found[0].isfinite().all()
    assert found[1].isnan().any()
