"""Layers commute with motions: by themselves, compiled, mapped, exported; and their gradients are exact."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

torch = pytest.importorskip("torch")

from torch import Tensor, nn  # noqa: E402

from tests.learn.test_algebra_products import motions  # noqa: E402
from unisg_blender.learn.algebra import (  # noqa: E402
    EquivariantLinear,
    GatedNonlinearity,
    GeometricBilinear,
    InvariantAttention,
    MotionBlock,
    MultivectorNorm,
    embed_frame,
    embed_motor,
    extract_point,
    moved,
)

C, S, T = 4, 6, 5
LAYERS: dict[str, Callable[[str], nn.Module]] = {
    "linear": lambda symmetry: EquivariantLinear(C, 3, S, 2, symmetry),
    "norm": lambda _: MultivectorNorm(),
    "gate": lambda _: GatedNonlinearity(),
    "bilinear": lambda symmetry: GeometricBilinear(C, S, symmetry),
    "attention": lambda _: SelfAttention(),
    "block": lambda symmetry: Sighted(MotionBlock(C, S, 2, symmetry)),
}
BOUNDS = {torch.float32: 1e-5, torch.float64: 1e-12}


class SelfAttention(nn.Module):
    """Attention of elements among each other."""

    def __init__(self) -> None:
        super().__init__()
        self.layer = InvariantAttention(2)

    def forward(self, x: Tensor, numbers: Tensor) -> tuple[Tensor, Tensor]:
        """Of the shapes that go in."""
        one = (x, numbers)
        return self.layer(one, one, one, torch.ones(T, T, dtype=torch.bool, device=x.device))


class Sighted(nn.Module):
    """A block in which all elements see each other."""

    def __init__(self, block: MotionBlock) -> None:
        super().__init__()
        self.block = block

    def forward(self, x: Tensor, numbers: Tensor) -> tuple[Tensor, Tensor]:
        """Of the shapes that go in."""
        return self.block(x, numbers, torch.ones(T, T, dtype=torch.bool, device=x.device))


def made(name: str, symmetry: str = "motions", dtype: torch.dtype = torch.float64) -> nn.Module:
    torch.manual_seed(0)
    return LAYERS[name](symmetry).to(dtype).eval()


def inputs(seed: int = 0, dtype: torch.dtype = torch.float64) -> tuple[Tensor, Tensor]:
    rng = np.random.default_rng(seed)
    return torch.tensor(rng.normal(size=(T, C, 16)), dtype=dtype), torch.tensor(rng.normal(size=(T, S)), dtype=dtype)


def apart(found: Tensor, expected: Tensor) -> float:
    """The largest difference, as a share of the largest value."""
    return float((found - expected).detach().abs().max() / expected.detach().abs().max())


@pytest.mark.parametrize("symmetry", ["motions", "rooms", "mirrors"])
@pytest.mark.parametrize("name", LAYERS)
@pytest.mark.parametrize("dtype", list(BOUNDS))
@settings(max_examples=10)
@given(seed=st.integers(0, 10_000))
def test_moving_what_goes_in_moves_what_comes_out(seed: int, name: str, symmetry: str, dtype: torch.dtype) -> None:
    layer, (x, numbers) = made(name, symmetry, dtype), inputs(seed, dtype)
    motor = embed_motor(torch.tensor(motions(1, seed, upright=symmetry == "rooms"), dtype=dtype))
    before, after = layer(x, numbers), layer(moved(motor, x), numbers)
    assert apart(after[0], moved(motor, before[0])) < BOUNDS[dtype]
    assert apart(after[1], before[1]) < BOUNDS[dtype]


def test_rooms_may_not_be_tipped_over() -> None:
    layer, (x, numbers) = made("block", "rooms"), inputs()
    motor = embed_motor(torch.tensor(motions(1, 4)))
    before, after = layer(x, numbers), layer(moved(motor, x), numbers)
    assert apart(after[0], moved(motor, before[0])) > 0.01


def test_elements_out_of_sight_count_not_and_who_sees_none_gathers_none() -> None:
    attention, (x, numbers) = InvariantAttention(2).double(), inputs()
    sees = torch.ones(T, T, dtype=torch.bool)
    sees[0, 3:], sees[1] = False, False
    other = x.clone()
    other[3:] *= 5
    found, changed = (attention((x, numbers), (keys, numbers), (keys, numbers), sees) for keys in (x, other))
    assert_allclose(found[0][0].detach(), changed[0][0].detach())
    assert not found[0][1].any()
    assert not found[1][1].any()
    assert not torch.allclose(found[0][2], changed[0][2])


def test_attention_falls_off_with_distance_as_each_head_learns() -> None:
    attention = InvariantAttention(1)
    frames = torch.eye(4).repeat(3, 1, 1)
    frames[:, 0, 3] = torch.tensor([0.0, 0.5, 4.0])
    points, none = embed_frame(frames)[:, :1], torch.zeros(3, 1)
    with torch.no_grad():
        attention.nearness.fill_(1.0)
        found, _ = attention((points, none), (points, none), (points, none), torch.ones(3, 3, dtype=torch.bool))
    near = extract_point(found[0, 0])
    assert 0.1 < float(near[0]) < 0.3  # of the middles at 0, 0.5 and 4 m, the last one counts next to nothing


def test_neighbours_give_what_a_mask_of_them_gives() -> None:
    block, (x, numbers) = MotionBlock(C, S).double(), inputs()
    neighbours = torch.tensor([[1, 2], [0, 4], [4, 3], [0, 1], [2, 0]])
    sees = torch.zeros(T, T, dtype=torch.bool).scatter(1, neighbours, True)
    some = block(x, numbers, torch.ones(T, 2, dtype=torch.bool), neighbours)
    for one, other in zip(block(x, numbers, sees), some, strict=True):
        assert_allclose(one.detach(), other.detach(), atol=1e-12)


@pytest.mark.parametrize("name", LAYERS)
def test_gradients_are_those_of_finite_differences(name: str) -> None:
    layer = made(name)
    leaves = [part.requires_grad_() for part in inputs(3)]
    assert torch.autograd.gradcheck(lambda *x: layer(*x), leaves, fast_mode=True)
    weights = [weight for weight in layer.parameters() if weight.numel()]

    def of_weights(*values: Tensor) -> tuple[Tensor, ...]:
        """The layer as a function of what it learns."""
        names = [key for key, weight in layer.named_parameters() if weight.numel()]
        return torch.func.functional_call(layer, dict(zip(names, values, strict=True)), inputs(3))

    if weights:
        assert torch.autograd.gradcheck(of_weights, [weight.detach().requires_grad_() for weight in weights],
                                        fast_mode=True)  # fmt: skip


@pytest.mark.parametrize("angle", [0.0, 1.0, np.pi])
def test_gradients_by_the_pose_are_exact_for_batches_of_rotations(angle: float) -> None:
    """Frames have no singular places: neither the identity nor half turns about an axis of the world."""
    block = MotionBlock(4, 2).double()
    cos, sin = np.cos(angle), np.sin(angle)
    turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    if angle == np.pi:
        turn = np.diag([-1.0, -1.0, 1.0])
    upper = torch.tensor(np.concatenate([np.tile(turn, (3, 1, 1)), np.arange(9.0).reshape(3, 3, 1)], axis=2))
    last = torch.tensor([0.0, 0.0, 0.0, 1.0], dtype=torch.float64).expand(3, 1, 4)

    def through(matrices: Tensor) -> tuple[Tensor, Tensor]:
        """Poses to what the block makes of them."""
        frames = embed_frame(torch.cat([matrices, last], dim=1))
        return block(frames, frames.new_ones(3, 2), torch.ones(3, 3, dtype=torch.bool))

    assert torch.autograd.gradcheck(through, upper.requires_grad_(), fast_mode=True)


@pytest.mark.parametrize("name", LAYERS)
def test_vmap_maps_them(name: str) -> None:
    layer, parts = made(name), [inputs(seed) for seed in range(3)]
    x, numbers = (torch.stack(each) for each in zip(*parts, strict=True))
    for one, other in zip(torch.func.vmap(layer)(x, numbers), layer(x, numbers), strict=True):
        assert_allclose(one.detach(), other.detach(), atol=1e-12)
    gradient = torch.func.vmap(torch.func.grad(lambda x, s: layer(x, s)[0].square().sum()))(x, numbers)
    assert gradient.isfinite().all()


@pytest.mark.parametrize("name", LAYERS)
def test_tensors_are_made_where_the_inputs_are(name: str) -> None:
    layer, given = made(name), inputs()
    expected = layer(*given)
    with torch.device("meta"):
        found = layer(*given)
        frames = embed_frame(torch.eye(4, device="cpu"))
    assert frames.device.type == "cpu"
    for one, other in zip(found, expected, strict=True):
        assert torch.equal(one, other)


@pytest.mark.slow
def test_torch_compiles_a_block_in_one_piece() -> None:
    block, (x, numbers) = made("block", dtype=torch.float32), inputs(dtype=torch.float32)
    compiled = torch.compile(block, fullgraph=True, backend="aot_eager")
    leaves = [x.clone().requires_grad_() for _ in range(2)]
    found, expected = compiled(leaves[0], numbers), block(leaves[1], numbers)
    assert_allclose(found[0].detach(), expected[0].detach(), atol=1e-5)
    for out, leaf in ((found, leaves[0]), (expected, leaves[1])):
        out[0].square().sum().backward()
        assert leaf.grad is not None
    assert apart(leaves[0].grad, leaves[1].grad) < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("symmetry", ["motions", "rooms"])
def test_an_exported_block_commutes_with_motions(symmetry: str, tmp_path: Path) -> None:
    onnxruntime = pytest.importorskip("onnxruntime")
    pytest.importorskip("onnx")
    from unisg_blender.learn.onnx_export import export_onnx

    block, (x, numbers) = MotionBlock(C, S, 2, symmetry), inputs(dtype=torch.float32)
    sees = torch.ones(T, T, dtype=torch.bool)
    given = {"x": x, "numbers": numbers, "mask": sees}
    dynamic = {"x": {0: "elements"}, "numbers": {0: "elements"}, "mask": {0: "elements", 1: "elements"}}
    export_onnx(block, given, ["y", "told"], dynamic, "{}", tmp_path / "block.onnx")
    session = onnxruntime.InferenceSession(tmp_path / "block.onnx", providers=["CPUExecutionProvider"])

    def exported(x: Tensor) -> list[Tensor]:
        """What onnxruntime computes."""
        named = {"x": x, "numbers": numbers, "mask": sees}
        return [torch.tensor(y) for y in session.run(None, {name: part.numpy() for name, part in named.items()})]

    for seed in range(5):
        motor = embed_motor(torch.tensor(motions(1, seed, upright=symmetry == "rooms"), dtype=torch.float32))
        before, after = exported(x), exported(moved(motor, x))
        assert apart(before[0], block(x, numbers, sees)[0].detach()) < 1e-5
        assert apart(after[0], moved(motor, before[0])) < 1e-5
        assert apart(after[1], before[1]) < 1e-5
