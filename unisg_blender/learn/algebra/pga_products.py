"""Products of multivectors of PGA as tensors: sixteen coefficients in the order of ``clifford.pga``, e0 first.

A product is linear in both factors, so it is a table of structure constants: what basis blade i times basis blade j
gives in blade k. Motors act on multivectors by the sandwich M x ~M, whatever these stand for.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from ...geometry.arrays import Floats
from ...poses.multivectors import PGA_BLADES

Blade = tuple[int, ...]
BLADES: tuple[Blade, ...] = tuple(tuple(map(int, name.removeprefix("e"))) if name != "1" else () for name in PGA_BLADES)
GRADES = tuple(map(len, BLADES))
SQUARES = (0, 1, 1, 1)
"""e0 squared, e1 squared ..."""


def _sorted(factors: Blade) -> tuple[int, Blade]:
    """Sign and indices of a product of basis vectors after swapping them into order."""
    swaps = sum(a > b for place, a in enumerate(factors) for b in factors[place + 1 :])
    return (-1) ** swaps, tuple(sorted(factors))


def _geometric(a: Blade, b: Blade) -> tuple[int, Blade]:
    sign, factors = _sorted(a + b)
    for index in set(a) & set(b):
        sign *= SQUARES[index]
    return sign, tuple(index for index in factors if factors.count(index) == 1)


def _outer(a: Blade, b: Blade) -> tuple[int, Blade]:
    return (0, ()) if set(a) & set(b) else _sorted(a + b)


def _complement(a: Blade) -> tuple[int, Blade]:
    """Sign and blade b with a ^ b = e0123."""
    rest = tuple(index for index in range(4) if index not in a)
    return _sorted(a + rest)[0], rest


def _join(a: Blade, b: Blade) -> tuple[int, Blade]:
    """The blade whose complement is the outer product of the complements."""
    (sign_a, dual_a), (sign_b, dual_b) = _complement(a), _complement(b)
    sign, dual = _outer(dual_a, dual_b)
    rest = tuple(index for index in range(4) if index not in dual)
    return sign * sign_a * sign_b * _complement(rest)[0], rest


def structure_constants(product: Callable[[Blade, Blade], tuple[int, Blade]]) -> Floats:
    """The table (16, 16, 16) of a product of basis blades."""
    table = np.zeros((16, 16, 16))
    for i, a in enumerate(BLADES):
        for j, b in enumerate(BLADES):
            sign, blade = product(a, b)
            table[i, j, BLADES.index(blade)] += sign
    return table


def _constant(values: Floats) -> Tensor:
    return torch.as_tensor(values, dtype=torch.float32, device="cpu")


GEOMETRIC = _constant(structure_constants(_geometric))
JOIN = _constant(structure_constants(_join))
REVERSED = _constant(np.array([(-1.0) ** (grade * (grade - 1) // 2) for grade in GRADES]))
METRIC = _constant(np.array([float(0 not in blade) for blade in BLADES]))
"""1 for the eight blades without e0: what is left of <x ~x> of each blade."""


def _bilinear(table: Tensor, x: Tensor, y: Tensor) -> Tensor:
    rows, others = x.reshape(-1, 16), y.reshape(-1, 1, 16)  # as one matrix: a batch of small ones takes twice as long
    by_left = (rows @ table.to(x).reshape(16, 256)).unflatten(-1, (16, 16))
    return (others @ by_left).reshape(x.shape)


def geometric_product(x: Tensor, y: Tensor) -> Tensor:
    """The geometric product x y of multivectors (..., 16), leading axes broadcast."""
    return _bilinear(GEOMETRIC, *torch.broadcast_tensors(x, y))


def join(x: Tensor, y: Tensor) -> Tensor:
    """The regressive product of multivectors (..., 16): two points give their line, a point and a plane their distance.

    x v y is what has the outer product of the complements of x and y as its complement; ``clifford`` calls it ``vee``.
    It commutes with motors; a mirror turns its sign round, which GATr mends by a reference (EquiJoin).
    Source: Dorst and De Keninck, "A guided tour to the plane-based geometric algebra PGA", 2022.
    """
    return _bilinear(JOIN, *torch.broadcast_tensors(x, y))


def reverse(x: Tensor) -> Tensor:
    """~x of multivectors (..., 16): the factors of each blade in the opposite order."""
    return x * REVERSED.to(x)


def inner_product(x: Tensor, y: Tensor) -> Tensor:
    """<x ~y>, the invariant product (...) of multivectors (..., 16): the blades without e0, one by one."""
    return (x * y) @ METRIC.to(x)


def moved(motors: Tensor, x: Tensor) -> Tensor:
    """M x ~M of motors (..., 16) of norm 1 and multivectors (..., 16): the motion that they stand for."""
    return geometric_product(geometric_product(motors, x), reverse(motors))
