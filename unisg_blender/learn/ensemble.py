"""Many small networks of one shape, trained side by side as one: for tables over seeds and learning rates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import torch
from torch import Tensor, nn


class StackedMlp(nn.Module):
    """S networks: a linear layer to the first of the ``hidden`` widths, layers between these, a linear layer out.

    The layers between are drawn first and by ``seeds`` alone, so that networks that differ only in the widths of
    inputs and outputs start alike. GELU follows every layer but the last and those that make it narrower (bottlenecks).
    """

    def __init__(self, inputs: int, outputs: int, seeds: Sequence[int], hidden: Sequence[int] = (64, 64, 64)) -> None:
        super().__init__()
        shapes = [*pairwise(hidden), (inputs, hidden[0]), (hidden[-1], outputs)]
        drawn = [_draw(shapes, seed) for seed in seeds]
        self.weights = nn.ParameterList(torch.stack([one[0][k] for one in drawn]) for k in range(len(shapes)))
        self.biases = nn.ParameterList(torch.stack([one[1][k] for one in drawn]) for k in range(len(shapes)))
        last = len(shapes) - 1
        self.order = [last - 1, *range(last - 1), last]
        self.bent = [k == last - 1 or (k < last - 1 and hidden[k + 1] >= hidden[k]) for k in range(len(shapes))]

    @property
    def parameters_each(self) -> int:
        """Parameters of one of the networks."""
        return sum(weight[0].numel() for weight in self.parameters())

    def forward(self, x: Tensor) -> Tensor:
        """Outputs (S, B, outputs) of inputs (S, B, inputs)."""
        for place in self.order:
            x = torch.baddbmm(self.biases[place], x, self.weights[place])
            if self.bent[place]:
                x = nn.functional.gelu(x)
        return x


def _draw(shapes: Sequence[tuple[int, int]], seed: int) -> tuple[list[Tensor], list[Tensor]]:
    generator = torch.Generator().manual_seed(seed)
    weights, biases = [], []
    for width, out in shapes:
        limit = width**-0.5
        weights.append((2 * torch.rand(width, out, generator=generator) - 1) * limit)
        biases.append((2 * torch.rand(1, out, generator=generator) - 1) * limit)
    return weights, biases


def train_stacked(
    network: StackedMlp,
    x: Tensor,
    y: Tensor,
    rates: Sequence[float],
    loss: Callable[[Tensor, Tensor], Tensor],
    seeds: Sequence[int],
    steps: int = 600,
    batch: int = 64,
) -> None:
    """Adam, each network with a learning rate of its own that follows half a cosine to zero.

    Written out, since ``torch.optim.Adam`` has one rate for a whole tensor and here each slice of it has its own.

    Parameters
    ----------
    x, y
        (G, N, inputs) and (G, N, outputs) for G groups of networks that lie side by side, S / G each.
    rates
        S learning rates.
    loss
        Of outputs and targets (S, B, outputs): the loss of each network (S,).
    seeds
        G seeds of the batches; networks of a group see the same ones.
    """
    group = len(rates) // len(x)
    rate = torch.tensor(rates, device=x.device).reshape(-1, 1, 1)
    weights = list(network.parameters())
    first, second = ([torch.zeros_like(weight) for weight in weights] for _ in range(2))
    orders = torch.stack([_order(x.shape[1], steps * batch, seed) for seed in seeds]).to(x.device)
    groups = torch.arange(len(x), device=x.device)[:, None]
    for step in range(steps):
        rows = orders[:, step * batch : (step + 1) * batch]
        some, wanted = (part[groups, rows].repeat_interleave(group, dim=0) for part in (x, y))
        gradients = torch.autograd.grad(loss(network(some), wanted).sum(), weights)
        now = rate * (0.5 + 0.5 * torch.cos(torch.tensor(torch.pi * step / steps, device=x.device)))
        bias = (1 - 0.9 ** (step + 1), 1 - 0.999 ** (step + 1))
        with torch.no_grad():
            for weight, gradient, mean, square in zip(weights, gradients, first, second, strict=True):
                mean.lerp_(gradient, 0.1)
                square.lerp_(gradient.square(), 0.001)
                weight.sub_(now * (mean / bias[0]) / ((square / bias[1]).sqrt() + 1e-8))


def _order(count: int, length: int, seed: int) -> Tensor:
    """Rows in random order, again and again."""
    generator = torch.Generator().manual_seed(seed)
    rounds = [torch.randperm(count, generator=generator, device=generator.device) for _ in range(-(-length // count))]
    return torch.cat(rounds)[:length]
