"""The network over pairs of objects: does the first stand on the second?"""

from __future__ import annotations

import torch
from numpy.typing import NDArray
from torch import Tensor, nn


class PairNetwork(nn.Module):
    """Three hidden layers over the features of a pair, standardised inside.

    Parameters
    ----------
    mean, scale
        (C,): of the features of the training pairs.
    """

    mean: Tensor
    scale: Tensor

    def __init__(self, mean: NDArray, scale: NDArray, hidden: int = 64) -> None:
        super().__init__()
        self.register_buffer("mean", torch.as_tensor(mean, dtype=torch.float32))
        self.register_buffer("scale", torch.as_tensor(scale, dtype=torch.float32))
        self.layers = nn.Sequential(
            nn.Linear(len(mean), hidden), nn.GELU(), nn.Linear(hidden, hidden), nn.GELU(),
            nn.Linear(hidden, hidden), nn.GELU(), nn.Linear(hidden, 1),
        )  # fmt: skip

    def forward(self, features: Tensor) -> Tensor:
        """Logits (P,) of pairs with features (P, C)."""
        return self.layers((features - self.mean) / self.scale).squeeze(-1)
