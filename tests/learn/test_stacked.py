"""Networks trained side by side are what they would be alone."""

from __future__ import annotations

import pytest

torch = pytest.importorskip("torch")

from unisg_blender.learn.ensemble import StackedMlp, train_stacked  # noqa: E402


def mse(found: torch.Tensor, wanted: torch.Tensor) -> torch.Tensor:
    return (found - wanted).square().mean(dim=(1, 2))


def test_inner_layers_start_alike_whatever_the_widths() -> None:
    narrow, wide = StackedMlp(7, 3, [0, 1], (16, 16, 16)), StackedMlp(32, 9, [0, 1], (16, 16, 16))
    for place in (0, 1):
        assert torch.equal(narrow.weights[place], wide.weights[place])
    assert not torch.equal(narrow.weights[0][0], narrow.weights[0][1])
    assert narrow.parameters_each == (7 * 16 + 16) + 2 * (16 * 16 + 16) + (16 * 3 + 3)


@pytest.mark.slow
def test_each_network_learns_as_if_it_were_alone() -> None:
    generator = torch.Generator().manual_seed(0)
    x = torch.randn(2, 50, 5, generator=generator)
    y = x[..., :2] * x[..., 2:4]
    rates = [1e-3, 1e-2, 1e-3, 1e-2]
    together = StackedMlp(5, 2, [0, 0, 1, 1], (8, 8))
    train_stacked(together, x, y, rates, mse, [0, 1], steps=30, batch=16)
    alone = StackedMlp(5, 2, [1], (8, 8))
    before = mse(alone(x[1:]), y[1:]).item()
    train_stacked(alone, x[1:], y[1:], [1e-2], mse, [1], steps=30, batch=16)
    for one, two in zip(together.parameters(), alone.parameters(), strict=True):
        torch.testing.assert_close(one[3], two[0], atol=1e-5, rtol=1e-4)
    assert mse(alone(x[1:]), y[1:]).item() < before


def test_bottlenecks_pass_on_what_they_get() -> None:
    network = StackedMlp(4, 4, [0], (8, 2, 8))
    assert network(torch.zeros(1, 3, 4)).shape == (1, 3, 4)
    assert [weight.shape[1:] for weight in network.weights] == [(8, 2), (2, 8), (4, 8), (8, 4)]
    assert network.bent == [False, True, True, False]
