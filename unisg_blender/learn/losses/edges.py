"""Losses of predicted edges."""

from __future__ import annotations

from torch import Tensor, nn

from ..paper.gae import edge_logits


def edge_loss(embedding: Tensor, edges: Tensor, others: Tensor) -> Tensor:
    """Binary cross-entropy of edges and of pairs that are none: the mean of the two means."""
    one = nn.functional.softplus(-edge_logits(embedding, edges)).mean()
    none = nn.functional.softplus(edge_logits(embedding, others)).mean()
    return one + none
