"""The loss of a critic that ranks true places above drawn ones."""

from __future__ import annotations

from torch import Tensor


def ranking_loss(score: Tensor) -> Tensor:
    """Cross entropy (B,) of finding the true place, the first of (B, 1 + S)."""
    return -score.log_softmax(-1)[:, 0]
