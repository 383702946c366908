"""Layers on channels of multivectors (..., C, 16) with numbers (..., S) beside them that commute with motions.

Moving what goes in moves what comes out, and the numbers stay. The blueprint is GATr (Brehmer et al., "Geometric
Algebra Transformer", 2023, arXiv 2305.18415, section 3); the symmetry can be chosen, see :data:`.SYMMETRIES`. Spinner
et al., "Lorentz-equivariant geometric algebra transformers", 2024, arXiv 2405.14806, number the same layers:
linear (1), attention (2), norm (3).
"""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn

from .pga_products import METRIC, geometric_product, inner_product, join
from .symmetry_maps import commuting_maps, invariant_elements, invariant_parts

SMOOTHING = 0.01
"""What is added to squared sizes before they divide: multivectors of no size stay as small as they are."""


class EquivariantLinear(nn.Module):
    """All linear maps that commute with the motions of a symmetry: y = sum over k of w_k A_k x.

    With the symmetry ``mirrors`` GATr's, y = sum of w_k <x>_k + sum of v_k e0 <x>_k (its Proposition 1). Numbers turn
    into multiples of what no motion changes (1, e0, e0123), multivectors into numbers by their unchanging parts.

    Parameters
    ----------
    inputs, outputs
        Channels.
    numbers_in, numbers_out
        How many numbers go in and come out beside them.
    symmetry
        Name in :data:`.SYMMETRIES`.
    """

    maps: Tensor
    parts: Tensor
    elements: Tensor

    def __init__(
        self, inputs: int, outputs: int, numbers_in: int = 0, numbers_out: int = 0, symmetry: str = "motions"
    ) -> None:
        super().__init__()
        tables = {"maps": commuting_maps, "parts": invariant_parts, "elements": invariant_elements}
        for name, table in tables.items():
            self.register_buffer(name, torch.tensor(table(symmetry), dtype=torch.float32), persistent=False)
        self.weight = nn.Parameter(_uniform(outputs, inputs, len(self.maps), width=inputs))
        self.from_numbers = nn.Linear(numbers_in, outputs * len(self.elements))
        self.to_numbers = nn.Linear(numbers_in + inputs * len(self.parts), numbers_out)

    def forward(self, x: Tensor, numbers: Tensor) -> tuple[Tensor, Tensor]:
        """Multivectors (..., outputs, 16) and numbers (..., numbers_out) of (..., inputs, 16) and (..., numbers_in)."""
        whole = torch.einsum("oik,kba->iaob", self.weight, self.maps.to(x))
        size = (len(self.weight), 16)
        moved = x.flatten(-2) @ whole.flatten(2).flatten(0, 1)
        constant = self.from_numbers(numbers).unflatten(-1, (size[0], -1)) @ self.elements.to(x)
        unchanged = (x @ self.parts.to(x).T).flatten(-2)
        return moved.unflatten(-1, size) + constant, self.to_numbers(torch.cat([numbers, unchanged], dim=-1))


def _uniform(*shape: int, width: int) -> Tensor:
    return (2 * torch.rand(*shape) - 1) / math.sqrt(width)


class MultivectorNorm(nn.Module):
    """x / sqrt(mean over channels of <x ~x>): GATr's LayerNorm; numbers by their own mean and spread."""

    def forward(self, x: Tensor, numbers: Tensor) -> tuple[Tensor, Tensor]:
        """Of the shapes that go in."""
        size = inner_product(x, x).mean(dim=-1, keepdim=True) + SMOOTHING
        return x * size.rsqrt().unsqueeze(-1), nn.functional.layer_norm(numbers, numbers.shape[-1:])


class GatedNonlinearity(nn.Module):
    """GELU(x_1) x, with x_1 the scalar part of each channel: GATr's GatedGELU; GELU of the numbers."""

    def forward(self, x: Tensor, numbers: Tensor) -> tuple[Tensor, Tensor]:
        """Of the shapes that go in."""
        return nn.functional.gelu(x[..., :1]) * x, nn.functional.gelu(numbers)


class GeometricBilinear(nn.Module):
    """Half of the channels are geometric products x y, half are joins x v y, of linear maps of what goes in.

    GATr's Geometric(x, y) = Concat(x y, EquiJoin(x, y)). Motions need no reference for the join; with the symmetry
    ``mirrors`` it is equivariant up to its sign.
    """

    def __init__(self, channels: int, numbers: int, symmetry: str = "motions") -> None:
        super().__init__()
        self.products = max(1, channels // 2)
        self.factors = EquivariantLinear(channels, 4 * self.products, numbers, numbers, symmetry)
        self.out = EquivariantLinear(2 * self.products, channels, numbers, numbers, symmetry)

    def forward(self, x: Tensor, numbers: Tensor) -> tuple[Tensor, Tensor]:
        """Of the shapes that go in."""
        factors, numbers = self.factors(x, numbers)
        one, two, three, four = factors.split(self.products, dim=-2)
        return self.out(torch.cat([geometric_product(one, two), join(three, four)], dim=-2), numbers)


class InvariantAttention(nn.Module):
    """Attention whose weights no motion changes: softmax over keys of products of queries with them.

    GATr's: sum over channels of <q ~k> / sqrt(8 C), with products of the numbers beside it, and its distance-aware
    term: less attention to points that are further away, by a factor that each head learns.
    """

    def __init__(self, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.nearness = nn.Parameter(torch.zeros(heads))

    def forward(
        self, query: tuple[Tensor, Tensor], key: tuple[Tensor, Tensor], value: tuple[Tensor, Tensor], mask: Tensor
    ) -> tuple[Tensor, Tensor]:
        """What queries gather: multivectors (..., Q, C, 16) and numbers (..., Q, S).

        Each of ``query``, ``key``, ``value`` is such a pair, keys and values with T rows in the place of Q; C and S are
        multiples of the heads. ``mask`` bool (..., Q, T) says which keys there are; without any, nothing is gathered.
        """
        (q, s), (k, r), (v, u) = (self._split(pair) for pair in (query, key, value))
        asked, told = torch.cat([(q * METRIC.to(q)).flatten(-2), s], -1), torch.cat([k.flatten(-2), r], -1)
        logits = asked @ told.transpose(-1, -2) / math.sqrt(8 * q.shape[-2])
        near = torch.nn.functional.softplus(self.nearness)[:, None, None]
        logits = logits - near * _squared_distances(q, k)
        there = mask.unsqueeze(-3)
        share = torch.where(there, logits, logits.new_tensor(-1e9)).softmax(-1) * there
        found, numbers = share @ v.flatten(-2), share @ u
        return self._joined(found.unflatten(-1, v.shape[-2:])), numbers.transpose(-2, -3).flatten(-2)

    def _split(self, pair: tuple[Tensor, Tensor]) -> tuple[Tensor, Tensor]:
        """Multivectors (..., heads, T, C / heads, 16) and numbers (..., heads, T, S / heads)."""
        x, numbers = pair
        split = x.unflatten(-2, (self.heads, -1)).movedim(-3, -4)
        return split, numbers.unflatten(-1, (self.heads, -1)).transpose(-2, -3)

    @staticmethod
    def _joined(x: Tensor) -> Tensor:
        return x.movedim(-4, -3).flatten(-3, -2)


def _squared_distances(q: Tensor, k: Tensor) -> Tensor:
    """Mean over channels of squared distances (..., Q, T) of the points in (..., Q, C, 16) and (..., T, C, 16).

    A point of weight w counts as much as w^2 / (w^2 + smoothing) says: what is at infinity is at no distance.
    """
    (p, a), (r, b) = (x[..., 11:15].split([3, 1], dim=-1) for x in (q, k))
    left = torch.cat([a * a, (p * p).sum(-1, keepdim=True), a * p], -1) / (a * a + SMOOTHING)
    right = torch.cat([(r * r).sum(-1, keepdim=True), b * b, -2 * b * r], -1) / (b * b + SMOOTHING)
    return (left.flatten(-2) @ right.flatten(-2).transpose(-1, -2)) / q.shape[-2]
