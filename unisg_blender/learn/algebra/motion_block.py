"""A block of layers that commutes with motions: attention among elements, then products of what each has gathered."""

from __future__ import annotations

from torch import Tensor, nn

from .equivariant_layers import (
    EquivariantLinear,
    GatedNonlinearity,
    GeometricBilinear,
    InvariantAttention,
    MultivectorNorm,
)


class MotionBlock(nn.Module):
    """x + Linear(Attention(Linear(Norm(x)))), then x + Linear(Gate(Bilinear(Norm(x)))): GATr's transformer block.

    Parameters
    ----------
    channels, numbers
        C multivectors and S numbers of each element, multiples of ``heads``.
    heads
        Heads of attention.
    symmetry
        Name in :data:`.SYMMETRIES`.
    """

    def __init__(self, channels: int, numbers: int, heads: int = 2, symmetry: str = "motions") -> None:
        super().__init__()
        self.norm, self.gate, self.attention = MultivectorNorm(), GatedNonlinearity(), InvariantAttention(heads)
        self.asked = EquivariantLinear(channels, 3 * channels, numbers, 3 * numbers, symmetry)
        self.gathered = EquivariantLinear(channels, channels, numbers, numbers, symmetry)
        self.products = GeometricBilinear(channels, numbers, symmetry)
        self.out = EquivariantLinear(channels, channels, numbers, numbers, symmetry)

    def forward(
        self, x: Tensor, numbers: Tensor, mask: Tensor, neighbours: Tensor | None = None
    ) -> tuple[Tensor, Tensor]:
        """Of the shapes that go in, (..., T, C, 16) and (..., T, S).

        Parameters
        ----------
        mask
            bool (..., T, T): which elements each one sees; (T, K) with ``neighbours``.
        neighbours
            int64 (T, K): the elements that each one sees, if not all, of x (T, C, 16) and numbers (T, S).
        """
        asked, told = self.asked(*self.norm(x, numbers))
        query, key, value = zip(asked.chunk(3, dim=-2), told.chunk(3, dim=-1), strict=True)
        if neighbours is None:
            gathered = self.attention(query, key, value, mask)
        else:
            one = (query[0].unsqueeze(-3), query[1].unsqueeze(-2))
            some = [(pair[0][neighbours], pair[1][neighbours]) for pair in (key, value)]
            found = self.attention(one, some[0], some[1], mask.unsqueeze(-2))
            gathered = (found[0].squeeze(-3), found[1].squeeze(-2))
        x, numbers = _sum((x, numbers), self.gathered(*gathered))
        bent = self.gate(*self.products(*self.norm(x, numbers)))
        return _sum((x, numbers), self.out(*bent))


def _sum(one: tuple[Tensor, Tensor], other: tuple[Tensor, Tensor]) -> tuple[Tensor, Tensor]:
    return one[0] + other[0], one[1] + other[1]
